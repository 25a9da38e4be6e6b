//! The variable `KINETARIUM_ISA` chooses the instruction set.

use kinetarium_numbers::dispatch::{Isa, IsaError, VARIABLE};

/// The one test of its program, since it sets a variable of the process.
#[test]
fn the_variable_overrides_detection() {
    // SAFETY: no other thread reads or writes the environment.
    unsafe { std::env::remove_var(VARIABLE) };
    assert_eq!(Isa::from_env(), Ok(Isa::detect()));
    for isa in Isa::available() {
        // SAFETY: as above.
        unsafe { std::env::set_var(VARIABLE, isa.name()) };
        assert_eq!(Isa::from_env(), Ok(isa));
    }
    // SAFETY: as above.
    unsafe { std::env::set_var(VARIABLE, "sse") };
    assert_eq!(Isa::from_env(), Err(IsaError::Unknown("sse".to_owned())));
}
