//! No code, only dependencies: those that the headless build and the window share, with the
//! features that the window's crates turn on. As a member of the workspace it lets both use one
//! build; without it each command compiles Bevy, rapier and their dependents again.
