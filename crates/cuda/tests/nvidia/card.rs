//! The card that tests run on.

/// An NVIDIA card.
pub type Card = kinetarium_cuda::Cuda;

/// Kernels that a step and a read of joints take: one more gathers whether worlds run.
pub const KERNELS: usize = 3;

/// The first that there is.
pub fn card() -> Card {
    Card::open(0).unwrap()
}

/// The same, as if kernels of piles saw no more bytes of a buffer.
pub fn small(most_bytes: u64) -> Card {
    Card::open_within(0, most_bytes).unwrap()
}

/// Whether it rounds each operation, as the processor does.
pub fn rounds_alike(_: &Card) -> bool {
    true
}
