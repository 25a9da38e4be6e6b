//! The card that tests run on.

/// An NVIDIA card.
pub type Card = kinetarium_cuda::Cuda;

/// The first that there is.
pub fn card() -> Card {
    Card::open(0).unwrap()
}

/// Whether it rounds each operation, as the processor does.
pub fn rounds_alike(_: &Card) -> bool {
    true
}
