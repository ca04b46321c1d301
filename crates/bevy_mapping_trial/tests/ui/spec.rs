use crate::screen::{Screen, show_in};
use bevy_mapping_trial::ui::*;
use envgen::{Seed, WorldKind, WorldSpec};

fn form(kind: WorldKind) -> SpecForm {
    SpecForm::new(&kind.default_spec(), Seed(3))
}

#[test]
fn what_is_not_touched_comes_back_as_it_was() {
    for &kind in WorldKind::ALL {
        let (spec, seed) = form(kind).request().expect("defaults are allowed");
        assert_eq!((spec, seed), (kind.default_spec(), Seed(3)), "{kind}");
    }
}

#[test]
fn errors_are_below_the_setting_they_name() {
    let mut form = form(WorldKind::Indoor);
    form.set("difficulty", "11");
    let text = "`difficulty` must be a number from 0 to 10, got 11";
    assert_eq!(form.error_of("difficulty"), Some(text));
    assert!(show_in(egui::vec2(340.0, 4000.0), |ui| drop(form.show(ui))).has(text));
    assert!(form.request().is_err());
    form.set("difficulty", "9.5");
    assert_eq!(form.error_of("difficulty"), None);
    assert!(form.request().is_ok());
    // Settings that exclude each other.
    form.set("doorway", "2.9");
    assert!(form.error_of("doorway").is_some_and(|error| error.contains("2.9")));
}

#[test]
fn a_failure_is_shown_until_the_next_change() {
    let mut form = form(WorldKind::Indoor);
    let screen = Screen::new(egui::vec2(340.0, 4000.0));
    screen.retype("indoor.envgen.ron", "no/such.ron", |ui| form.show_file(ui));
    screen.click("Save", |ui| form.show_file(ui));
    assert!(screen.show(|ui| drop(form.show(ui))).has("no/such.ron"));
    // An error of one setting, which prevents the check of the others.
    form.set("doorway", "2.9");
    assert!(form.error_of("doorway").is_some());
    assert!(!screen.show(|ui| drop(form.show(ui))).has("no/such.ron"));
}

#[test]
fn files_of_others_are_replaced_by_a_second_click() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("notes.ron");
    std::fs::write(&path, "notes").expect("written");
    let name = path.display().to_string();
    let mut form = form(WorldKind::Forest);
    let screen = Screen::new(egui::vec2(3000.0, 900.0));
    screen.retype("forest.envgen.ron", &name, |ui| form.show_file(ui));
    assert_eq!(screen.click("Save", |ui| form.show_file(ui)), None);
    assert!(screen.show(|ui| drop(form.show(ui))).has(&format!("{name} exists")));
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), "notes");
    let saved = Some(SpecAction::Saved(path.clone()));
    assert_eq!(screen.click("Replace", |ui| form.show_file(ui)), saved);
    let text = std::fs::read_to_string(&path).expect("a file");
    assert_eq!(WorldSpec::from_ron(&text), form.request().map(|(spec, _)| spec));
    assert!(!screen.show(|ui| drop(form.show(ui))).has("exists"));
    // Its own file is replaced by the first click.
    form.set("intensity", "0.2");
    assert_eq!(screen.click("Save", |ui| form.show_file(ui)), saved);
    assert_ne!(std::fs::read_to_string(&path).expect("a file"), text);
}

#[test]
fn other_kinds_keep_what_was_typed() {
    let mut form = form(WorldKind::Hallway);
    form.set("segments", "80");
    form.set_kind(WorldKind::Forest);
    form.set_kind(WorldKind::Hallway);
    let (spec, _) = form.request().expect("allowed");
    assert_eq!(spec.settings_json()["segments"], 80);
}

#[test]
fn what_is_changed_is_reported() {
    let mut form = form(WorldKind::Forest);
    let screen = Screen::new(egui::vec2(340.0, 900.0));
    assert_eq!(screen.click("kind", |ui| form.show(ui)), None);
    assert_eq!(screen.click("Next", |ui| form.show(ui)), Some(SpecAction::Changed));
    assert_eq!(form.seed(), Seed(4));
    form.set("intensity", "0.2");
    assert_eq!(screen.click("Defaults", |ui| form.show_file(ui)), Some(SpecAction::Changed));
    assert_eq!(form.request(), Ok((WorldKind::Forest.default_spec(), Seed(4))));
}

#[test]
fn seeds_keep_all_their_digits() {
    let mut form = SpecForm::new(&WorldKind::Forest.default_spec(), Seed(u64::MAX - 1));
    let screen = Screen::new(egui::vec2(340.0, 900.0));
    assert!(screen.show(|ui| drop(form.show(ui))).has("18446744073709551614"));
    screen.click("Next", |ui| form.show(ui));
    assert_eq!(form.request().map(|(_, seed)| seed), Ok(Seed(u64::MAX)));
    let typed = "9007199254740993";
    let said = screen.retype("18446744073709551615", typed, |ui| form.show(ui));
    assert_eq!((said, form.seed()), (Some(SpecAction::Changed), Seed(9_007_199_254_740_993)));
    for wrong in ["-1", "1e3", "18446744073709551616"] {
        screen.retype(&form.seed().to_string(), wrong, |ui| form.show(ui));
        let error = format!("`seed` must be a whole number from 0 to {}, got {wrong}", u64::MAX);
        assert!(screen.show(|ui| drop(form.show(ui))).has(&error), "{wrong}");
        assert_eq!(form.request().expect_err("no seed").to_string(), error);
        assert_eq!(form.seed(), Seed(9_007_199_254_740_993));
        screen.retype(wrong, typed, |ui| form.show(ui));
        assert!(form.request().is_ok());
    }
}

#[test]
fn groups_with_errors_have_another_colour() {
    let mut form = form(WorldKind::Indoor);
    let colour = |form: &mut SpecForm| {
        show_in(egui::vec2(340.0, 900.0), |ui| drop(form.show_groups(ui))).colour_of("layout")
    };
    let before = colour(&mut form);
    form.set("spacing_h", "20");
    assert!(form.error_of("spacing_h").is_some());
    assert_ne!(colour(&mut form), before);
}

#[test]
fn the_world_of_a_file_stays_until_a_kind_is_chosen() {
    let mut form = SpecForm::of_file("cave.json", Seed(3));
    let screen = Screen::new(egui::vec2(340.0, 900.0));
    let shown = screen.show(|ui| {
        form.show(ui);
        form.show_groups(ui);
        form.show_file(ui);
    });
    assert!(shown.has("world from cave.json"));
    for of_kind in ["indoor", "difficulty", "layout", "Defaults", "Save"] {
        assert!(!shown.has(of_kind), "{of_kind}");
    }
    // The seed is that of the noise.
    assert_eq!(screen.click("Next", |ui| form.show(ui)), Some(SpecAction::Changed));
    assert_eq!((form.is_of_file(), form.request_seed()), (true, Ok(Seed(4))));
    screen.retype("4", "x", |ui| form.show(ui));
    assert!(form.request_seed().is_err_and(|error| error.to_string().contains("got x")));
    screen.retype("x", "5", |ui| form.show(ui));
    // A kind is chosen, and then the file again.
    assert_eq!(screen.click("world from cave.json", |ui| form.show(ui)), None);
    assert_eq!(screen.click("forest", |ui| form.show(ui)), Some(SpecAction::Changed));
    assert_eq!((form.is_of_file(), form.kind()), (false, WorldKind::Forest));
    assert!(screen.show(|ui| drop(form.show(ui))).has("intensity"));
    assert_eq!(screen.click("forest", |ui| form.show(ui)), None);
    let chosen = screen.click("world from cave.json", |ui| form.show(ui));
    assert_eq!((chosen, form.is_of_file()), (Some(SpecAction::Changed), true));
    assert_eq!(form.seed(), Seed(5));
}

#[test]
fn long_names_of_files_are_cut() {
    let mut form = SpecForm::of_file(&format!("{}.json", "long_".repeat(20)), Seed(3));
    let shown = show_in(egui::vec2(340.0, 400.0), |ui| drop(form.show(ui)));
    assert_eq!(shown.clipped(), Vec::<String>::new());
}

#[test]
fn saved_specs_are_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("some.envgen.ron");
    let mut form = form(WorldKind::Landscape);
    form.set("total_edge", "1000");
    form.save(&path).expect("written");
    let text = std::fs::read_to_string(&path).expect("a file");
    assert_eq!(WorldSpec::from_ron(&text), form.request().map(|(spec, _)| spec));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    let error = form.save(&folder.path().join("no/such.ron")).expect_err("no folder");
    assert!(error.contains("no/such.ron"), "{error}");
}

/// Creates the form of a map of 8 x 8 cells whose difficulty is the one that trials measure.
fn calibrated() -> SpecForm {
    let mut form = SpecForm::new(&SpecForm::initial(WorldKind::Indoor), Seed(3));
    form.set("width", "8");
    form.set("height", "8");
    form
}

#[test]
fn difficulties_out_of_reach_are_refused_below_the_slider() {
    let mut form = calibrated();
    let [least, most] = form.reached("difficulty").expect("a dial");
    let shown = format!("within reach: {least:.1} to {most:.1}, as trials measure it");
    assert!(show_in(egui::vec2(340.0, 4000.0), |ui| drop(form.show(ui))).has(&shown));
    assert!(form.request().is_ok(), "{least} to {most}");
    for (asked, is_reached) in
        [(least - 0.2, false), (least + 0.1, true), (most - 0.1, true), (most + 0.2, false)]
    {
        let asked = format!("{asked:.3}");
        form.set("difficulty", &asked);
        assert_eq!(form.error_of("difficulty").is_none(), is_reached, "{asked}");
        assert_eq!(form.request().is_ok(), is_reached, "{asked}");
    }
    let error = form.error_of("difficulty").expect("out of reach").to_owned();
    let expected = format!(
        "`difficulty` must be from {least:.1} to {most:.1}, what the profile calibrated reaches at 8 x 8 \
         cells with these settings"
    );
    assert!(error.starts_with(&expected), "{error}");
    // A larger map of the same difficulty, and then the same with the rules of the thesis.
    form.set("width", "16");
    form.set("height", "16");
    assert_ne!(form.reached("difficulty"), Some([least, most]));
    for profile in ["guaranteed", "thesis"] {
        form.set("profile", profile);
        assert_eq!(form.reached("difficulty"), None);
        assert!(form.request().is_ok(), "{profile}");
    }
}

#[test]
fn two_dials_replace_the_difficulty() {
    let mut form = calibrated();
    form.set("mapping", "4");
    assert_eq!(form.reached("difficulty"), None);
    let [least, most] = form.reached("mapping").expect("a dial");
    assert!((least..most).contains(&4.0), "{least} to {most}");
    assert_eq!(form.reached("navigation"), None);
    // The difficulty is no longer requested.
    form.set("difficulty", "0");
    assert!(form.request().is_ok());
    form.set("navigation", "9.9");
    let [_, most] = form.reached("navigation").expect("a dial");
    let is_reached = 9.9 <= most;
    assert_eq!(form.error_of("navigation").is_none(), is_reached);
    form.set("navigation", "none");
    form.set("mapping", "none");
    assert!(form.error_of("difficulty").is_some());
    form.set("profile", "guaranteed");
    form.set("mapping", "4");
    let error = form.error_of("mapping").expect("another profile");
    assert!(error.contains("except in the profile calibrated"), "{error}");
}

#[test]
fn what_is_kept_narrows_what_is_reached() {
    let mut form = calibrated();
    let [_, free] = form.reached("difficulty").expect("a dial");
    form.set("fixed", "floor_slip, wheel_bias, dark_walls, dark_objects");
    let [_, kept] = form.reached("difficulty").expect("a dial");
    assert!(kept < free - 1.0, "{kept} {free}");
}

#[test]
fn indoor_maps_begin_calibrated() {
    let mut form = form(WorldKind::Hallway);
    form.set_kind(WorldKind::Indoor);
    let (spec, _) = form.request().expect("allowed");
    assert_eq!(spec.settings_json()["profile"], "calibrated");
}
