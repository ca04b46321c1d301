//! Computations in the background, of which only the last request counts.

use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task, TaskPool};

/// A computation for the last of many requests, which may arrive faster than results.
///
/// At most one computation runs at a time. Of the requests that arrive meanwhile, only the last is computed.
#[derive(Debug)]
pub(super) struct Background<K, T> {
    running: Option<(K, Task<T>)>,
    done: Option<(K, T)>,
}

impl<K, T> Default for Background<K, T> {
    fn default() -> Self {
        Background { running: None, done: None }
    }
}

impl<K: Clone + PartialEq + Send + 'static, T: Send + 'static> Background<K, T> {
    /// Takes a result that is ready, and starts to compute `wanted` unless it is running or done. Must be
    /// called in every frame.
    pub(super) fn advance(&mut self, wanted: Option<&K>, make: fn(&K) -> T) {
        if let Some((_, task)) = &mut self.running
            && let Some(result) = check_ready(task)
            && let Some((key, _)) = self.running.take()
        {
            self.done = Some((key, result));
        }
        if let Some(wanted) = wanted
            && self.running.is_none()
            && self.of(wanted).is_none()
        {
            let key = wanted.clone();
            let task = AsyncComputeTaskPool::get_or_init(TaskPool::default)
                .spawn(async move { make(&key) });
            self.running = Some((wanted.clone(), task));
        }
    }

    /// Returns the result for exactly this request.
    pub(super) fn of(&self, wanted: &K) -> Option<&T> {
        self.done.as_ref().filter(|(key, _)| key == wanted).map(|(_, result)| result)
    }

    /// Returns the last result, which may be that of an earlier request.
    pub(super) fn last(&self) -> Option<&(K, T)> {
        self.done.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::time::Duration;

    use super::*;

    /// The requests that were computed, in order.
    static COMPUTED: Mutex<Vec<u32>> = Mutex::new(Vec::new());

    fn square(n: &u32) -> u32 {
        std::thread::sleep(Duration::from_millis(20));
        COMPUTED.lock().expect("no panic").push(*n);
        n * n
    }

    #[test]
    fn the_last_of_many_requests_is_computed() {
        let mut background = Background::default();
        for n in 1..=100 {
            background.advance(Some(&n), square);
        }
        while background.of(&100).is_none() {
            background.advance(Some(&100), square);
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(background.last(), Some(&(100, 10_000)));
        let computed = COMPUTED.lock().expect("no panic");
        // The first computation is running before the others are requested, and some may start between two
        // requests.
        assert!(computed.len() < 10 && computed.last() == Some(&100), "{computed:?}");
    }
}
