//! The card that tests run on.

/// A card of any maker.
pub type Card = kinetarium_gpu::Gpu;

/// Whatever card there is, or the program that `KINETARIUM_GPU` names, such as Mesa's `llvmpipe`.
pub fn card() -> Card {
    let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    Card::open(&name.parse().unwrap()).unwrap()
}
