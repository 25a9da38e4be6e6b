//! The tests of worlds on cards, those of `gpu` among them, on an NVIDIA card, or on what stands in for its driver
//! (`driver/README.md`).

#[path = "../../../gpu/tests/cards/agreement.rs"]
mod agreement;
mod bits;
mod card;
#[path = "../../../rigid/tests/scene/every_gauge.rs"]
mod every_gauge;
#[path = "../../../gpu/tests/cards/gauges.rs"]
mod gauges;
#[path = "../../../rigid/tests/scene/models.rs"]
mod models;
mod own;
#[path = "../../../gpu/tests/cards/pair.rs"]
mod pair;
#[path = "../../../gpu/tests/cards/piles.rs"]
mod piles;
#[path = "../../../gpu/tests/cards/ranges.rs"]
mod ranges;
#[path = "../../../gpu/tests/cards/reports.rs"]
mod reports;
#[path = "../../../gpu/tests/cards/scenes.rs"]
mod scenes;
#[path = "../../../rigid/tests/scene/surroundings.rs"]
mod surroundings;
#[path = "../../../gpu/tests/cards/wgsl.rs"]
mod wgsl;
#[path = "../../../gpu/tests/cards/worlds.rs"]
mod worlds;
