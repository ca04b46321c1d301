//! A crate without code, only with dependencies: those that the headless build and the build with a window
//! share, with the features that the crates of the window turn on. As a member of the workspace, it lets both
//! commands use one build. Without it, each command would compile Bevy, rapier and their dependents again.
