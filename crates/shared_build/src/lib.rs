//! No code, only dependencies: those that the headless build and the window have in common, with the
//! features that the window's crates turn on. As a member of the workspace it makes them one build;
//! without it each command compiles Bevy, rapier and all that depends on them for itself.
