//! The card that tests run on.

/// A card of any maker.
pub type Card = kinetarium_gpu::Gpu;

/// Kernels that a step and a read of joints take.
pub const KERNELS: usize = 2;

/// Whatever card there is, or the program that `KINETARIUM_GPU` names, such as Mesa's `llvmpipe`.
pub fn card() -> Card {
    let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    Card::open(&name.parse().unwrap()).unwrap()
}

/// The same, as if it took no more bytes in a buffer.
pub fn small(most_bytes: u64) -> Card {
    let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    Card::open_within(&name.parse().unwrap(), most_bytes).unwrap()
}

/// Whether it rounds each operation, as the portable reading does: Mesa's program does, others fuse.
pub fn rounds_alike(card: &Card) -> bool {
    card.name().contains("llvmpipe")
}
