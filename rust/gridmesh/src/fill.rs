//! Filling holes with grid patches.

mod develop;
mod exact;
mod flat;
mod flips;
mod graded;
mod grown;
mod quality;
mod settle;
mod small;
mod walls;
