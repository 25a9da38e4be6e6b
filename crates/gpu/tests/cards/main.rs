//! Worlds on a card beside worlds on the processor: whatever card there is, or the program that `KINETARIUM_GPU`
//! names, such as Mesa's `llvmpipe`.

mod agreement;
mod card;
#[path = "../../../rigid/tests/scene/every_gauge.rs"]
mod every_gauge;
mod gauges;
#[path = "../../../rigid/tests/scene/models.rs"]
mod models;
mod own;
mod pair;
mod piles;
mod ranges;
mod reports;
mod scenes;
#[path = "../../../rigid/tests/scene/surroundings.rs"]
mod surroundings;
mod wgsl;
mod worlds;
