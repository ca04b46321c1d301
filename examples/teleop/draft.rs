//! What a person has filled in of a form that is not handed in.

use std::io;
use std::path::{Path, PathBuf};

use bevy_mapping_trial::ui::FeedbackForm;
use envgen::located::Located;
use envgen::whole_file;
use mapping_trial::feedback::{Experience, Session};
use serde_json::json;

/// The file, in the folder of the trial.
const FILE: &str = "feedback_draft.json";

/// Saves a form beside the report, and returns the file; `None` if nothing is filled in.
pub(crate) fn save(
    form: &FeedbackForm,
    asked: &Session,
    folder: &Path,
) -> Option<Result<PathBuf, Located<io::Error>>> {
    let path = folder.join(FILE);
    is_begun(form, asked).then(|| write(form, &path).map(|()| path))
}

/// Whether a person has filled in anything. What is known of the session is in the form from the start.
fn is_begun(form: &FeedbackForm, asked: &Session) -> bool {
    let mut texts = form.answers.iter().chain([&form.name]);
    form.ratings.iter().any(Option::is_some)
        || texts.any(|text| !text.trim().is_empty())
        || form.experience != Experience::default()
        || form.session != *asked
}

/// Writes the form with the names of fields that it has in reports. Ratings that are missing are null.
fn write(form: &FeedbackForm, path: &Path) -> Result<(), Located<io::Error>> {
    let [difficulty, mapping, getting_around] = form.ratings;
    let [contributed, difficult_rooms, easy_rooms, patterns, other] = &form.answers;
    let Session { environment, software, connection, robots } = &form.session;
    let draft = json!({
        "name": form.name,
        "experience": form.experience,
        "environment": environment,
        "software": software,
        "connection": connection,
        "robots": robots,
        "difficulty": difficulty,
        "mapping": mapping,
        "getting_around": getting_around,
        "contributed": contributed,
        "difficult_rooms": difficult_rooms,
        "easy_rooms": easy_rooms,
        "patterns": patterns,
        "other": other,
    });
    let text = format!("{draft:#}\n");
    whole_file::write(path, text.as_bytes())
}
