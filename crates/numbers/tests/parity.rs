//! All instruction sets of this machine agree with plain scalars, to the bit.

#[path = "../examples/parity.rs"]
mod parity;

use kinetarium_numbers::dispatch::{Isa, IsaError};

#[test]
fn every_operation_on_every_instruction_set() {
    let (checks, failures) = parity::check_all();
    assert!(checks > 1_000_000, "only {checks} checks");
    let first: Vec<_> = failures.iter().take(20).collect();
    assert!(
        failures.is_empty(),
        "{} of {checks} failed: {first:#?}",
        failures.len()
    );
}

#[test]
fn instruction_sets_have_names() {
    for isa in Isa::available() {
        assert_eq!(isa.to_string().parse(), Ok(isa));
    }
    assert_eq!(
        "mmx".parse::<Isa>(),
        Err(IsaError::Unknown("mmx".to_owned()))
    );
    let absent = if cfg!(target_arch = "x86_64") {
        "neon"
    } else {
        "avx2"
    };
    let error = absent.parse::<Isa>().unwrap_err();
    assert_eq!(error, IsaError::Unavailable(absent.to_owned()));
    assert!(error.to_string().contains("portable"), "{error}");
}
