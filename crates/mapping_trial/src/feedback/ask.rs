//! Asks the questions of the form on a terminal.

use std::fmt::Display;
use std::io::{self, BufRead, Read, Write};
use std::str::FromStr;

use thiserror::Error;

use super::choice::{Connection, Experience};
use super::form::{Feedback, Session};
use super::questions;
use super::rating::Rating;

/// Greatest length of an answer in bytes.
pub const MAX_LINE: usize = 1 << 16;

/// An error for which the form was not filled.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FeedbackError {
    /// Reading from or writing to the terminal failed.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The input ended before the form did.
    #[error("the input ends at the question: {question}")]
    End {
        /// The question without an answer.
        question: String,
    },
    /// An answer is too long.
    #[error("an answer is longer than {MAX_LINE} bytes")]
    Long,
}

/// Asks the questions of the form in order, with one line per answer.
///
/// What is known of the session is shown in brackets, and an empty answer keeps it. An answer that is
/// not allowed is asked for again.
///
/// ```
/// use mapping_trial::feedback::{Connection, Experience, Session, ask};
/// use mapping_trial::robot::Robot;
///
/// let session = Session::new("office", 1, &Robot::default());
/// // Name and experience; the session as it is known; three ratings; five answers.
/// let mut answers = "Ada\nexperimental\n\n\n\n\n6\n5.5\n7\ndoors\nmaze\nlobby\nnone\nno\n".as_bytes();
/// let mut questions = Vec::new();
/// let feedback = ask(&session, &mut answers, &mut questions)?;
/// assert_eq!((feedback.name.as_str(), feedback.experience), ("Ada", Experience::Experimental));
/// assert_eq!(feedback.session.connection, Connection::Direct);
/// assert_eq!(feedback.mapping.value(), 5.5);
/// assert!(String::from_utf8_lossy(&questions).starts_with("Robot Mapping Feedback Form"));
/// # Ok::<(), mapping_trial::feedback::FeedbackError>(())
/// ```
///
/// # Errors
/// If the input ends, an answer is too long, or reading or writing fails.
pub fn ask(
    session: &Session,
    input: &mut dyn BufRead,
    out: &mut dyn Write,
) -> Result<Feedback, FeedbackError> {
    let mut form = Form { input, out };
    writeln!(form.out, "{}", questions::TITLE)?;
    let name = form.text(questions::NAME)?;
    let experience = form.choice(questions::EXPERIENCE, Experience::ALL, None)?;
    let environment = form.known(questions::ENVIRONMENT, &session.environment)?;
    let software = form.known(questions::SOFTWARE, &session.software)?;
    let connection =
        form.choice(questions::CONNECTION, Connection::ALL, Some(session.connection))?;
    let robots = form.known(questions::ROBOTS, &session.robots)?;
    let difficulty = form.rating(&format!(
        "{}\n  ({};\n  {})\n ",
        questions::DIFFICULTY,
        questions::DIFFICULTY_0,
        questions::DIFFICULTY_10
    ))?;
    let mapping = form.rating(questions::MAPPING)?;
    let getting_around = form.rating(questions::GETTING_AROUND)?;
    let contributed = form.text(questions::CONTRIBUTED)?;
    let difficult_rooms = form.text(questions::DIFFICULT_ROOMS)?;
    let easy_rooms = form.text(questions::EASY_ROOMS)?;
    let patterns = form.text(questions::PATTERNS)?;
    let other = form.text(questions::OTHER)?;
    Ok(Feedback {
        name,
        experience,
        session: Session { environment, software, connection, robots },
        difficulty,
        mapping,
        getting_around,
        contributed,
        difficult_rooms,
        easy_rooms,
        patterns,
        other,
    })
}

struct Form<'a> {
    input: &'a mut dyn BufRead,
    out: &'a mut dyn Write,
}

impl Form<'_> {
    fn text(&mut self, question: &str) -> Result<String, FeedbackError> {
        write!(self.out, "{question}: ")?;
        self.out.flush()?;
        let mut line = Vec::new();
        let mut most = (&mut *self.input).take(MAX_LINE as u64 + 1);
        let read = most.read_until(b'\n', &mut line)?;
        if read == 0 {
            return Err(FeedbackError::End { question: question.to_owned() });
        }
        if read > MAX_LINE {
            return Err(FeedbackError::Long);
        }
        Ok(String::from_utf8_lossy(&line).trim().to_owned())
    }

    fn known(&mut self, question: &str, known: &str) -> Result<String, FeedbackError> {
        let answer = self.text(&format!("{question} [{known}]"))?;
        Ok(if answer.is_empty() { known.to_owned() } else { answer })
    }

    fn choice<T>(&mut self, what: &str, all: &[T], known: Option<T>) -> Result<T, FeedbackError>
    where
        T: Copy + Display + FromStr<Err: Display>,
    {
        let choices: Vec<String> =
            (1..).zip(all).map(|(number, choice)| format!("{number} {choice}")).collect();
        let known_text = known.map_or(String::new(), |known| format!(" [{known}]"));
        let question = format!("{what} ({}){known_text}", choices.join(", "));
        loop {
            let answer = self.text(&question)?;
            if let Some(known) = known
                && answer.is_empty()
            {
                return Ok(known);
            }
            match answer.parse() {
                Ok(choice) => return Ok(choice),
                Err(error) => writeln!(self.out, "{error}")?,
            }
        }
    }

    fn rating(&mut self, question: &str) -> Result<Rating, FeedbackError> {
        loop {
            match self.text(&format!("{question} (0-10)"))?.parse() {
                Ok(rating) => return Ok(rating),
                Err(error) => writeln!(self.out, "{error}")?,
            }
        }
    }
}
