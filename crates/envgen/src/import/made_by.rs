//! The provenance of worlds that were read from files of other formats.

use serde_json::Value;

use crate::provenance::{IMPORT, Provenance};

/// Returns the provenance of the world from which a file was written. If that world was itself read from a file, it
/// is the provenance in that file, so that the values do not nest.
pub(super) fn made_by(found: Option<&Value>) -> Option<Value> {
    let provenance: Provenance = serde_json::from_value(found?.clone()).ok()?;
    match provenance.spec.get("made_by") {
        Some(made_by) if provenance.kind == IMPORT && !made_by.is_null() => Some(made_by.clone()),
        _ => serde_json::to_value(provenance).ok(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::{Blueprint, Seed, Spec, hallway::HallwaySpec};

    #[test]
    fn what_is_read_and_written_again_does_not_nest() {
        let world = HallwaySpec::default().generate(Seed(7)).unwrap().to_world();
        let first = serde_json::to_value(&world.provenance).unwrap();
        let mut written = first.clone();
        for _ in 0..3 {
            let read = Provenance::other(IMPORT, json!({ "made_by": made_by(Some(&written)) }));
            written = serde_json::to_value(read).unwrap();
            assert_eq!(made_by(Some(&written)).as_ref(), Some(&first));
        }
        // A file of others is the first that is known.
        let foreign = Provenance::other(IMPORT, json!({ "format": "houseexpo", "made_by": null }));
        let first = serde_json::to_value(foreign).unwrap();
        let read = Provenance::other(IMPORT, json!({ "made_by": made_by(Some(&first)) }));
        assert_eq!(made_by(Some(&serde_json::to_value(read).unwrap())), Some(first));
        assert_eq!(made_by(Some(&json!("nothing"))), None);
        assert_eq!(made_by(None), None);
    }
}
