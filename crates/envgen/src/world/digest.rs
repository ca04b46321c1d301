//! Digests that identify worlds by their content.

use std::fmt;
use std::io::{self, Write};

use serde::Serialize;
use sha2::{Digest as _, Sha256};

use super::World;

/// The SHA-256 digest of a value's canonical JSON. Two worlds with equal digests are equal to the last bit.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Digest([u8; 32]);

impl Digest {
    /// Computes the digest of any value that can be written as JSON.
    pub fn of<T: Serialize + ?Sized>(value: &T) -> Digest {
        let mut hash = io::BufWriter::with_capacity(1 << 16, Hash(Sha256::new()));
        let written = serde_json::to_writer(&mut hash, value);
        debug_assert!(written.is_ok(), "{written:?}");
        match hash.into_inner() {
            Ok(Hash(sha)) => Digest(sha.finalize().into()),
            Err(_) => unreachable!("a hash takes every byte"),
        }
    }
}

impl World {
    /// Computes the digest of everything except the provenance and the certificate: of the geometry alone.
    ///
    /// ```
    /// use envgen::{Blueprint, Seed, Spec, hallway::HallwaySpec};
    ///
    /// let mut world = HallwaySpec::default().generate(Seed(7))?.to_world();
    /// let digest = world.digest();
    /// world.provenance.edited = true;
    /// assert_eq!(world.digest(), digest);
    /// world.goal = None;
    /// assert_ne!(world.digest(), digest);
    /// // As text it has 64 hexadecimal digits.
    /// assert_eq!(digest.to_string().len(), 64);
    /// # Ok::<(), envgen::GenerateError>(())
    /// ```
    pub fn digest(&self) -> Digest {
        let parts = (
            (self.bounds, self.start, self.goal),
            (&self.walls, &self.trees, &self.road_strips, &self.rooms),
            (&self.doorways, &self.obstacles, &self.surfaces, &self.raster),
        );
        // Lists that later versions added count only when they hold something, so that the digests
        // of older worlds do not change.
        if self.victims.is_empty() {
            Digest::of(&parts)
        } else {
            Digest::of(&(parts, &self.victims))
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

struct Hash(Sha256);

impl Write for Hash {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
