//! The libraries of CUDA, which may be there or not. Without them all calls would panic.

#![allow(unsafe_code)]

use crate::CudaError;
use cudarc::{driver, nvrtc};

/// Looks for NVIDIA's driver.
pub(crate) fn find_driver() -> Result<(), CudaError> {
    // Safety: loading the driver runs nothing but what sets itself up.
    match unsafe { driver::sys::is_culib_present() } {
        true => Ok(()),
        false => Err(CudaError::NoDriver),
    }
}

/// Looks for NVRTC.
pub(crate) fn find_compiler() -> Result<(), CudaError> {
    // Safety: as above.
    match unsafe { nvrtc::sys::is_culib_present() } {
        true => Ok(()),
        false => Err(CudaError::NoCompiler),
    }
}

/// Whether the driver, which was found, tells the time between events by the call that is made here: since CUDA 12.8.
pub(crate) fn times_events() -> bool {
    let mut version = 0;
    // Safety: it writes a number, there.
    let asked = unsafe { driver::sys::cuDriverGetVersion(&mut version) };
    asked.result().is_ok() && version >= 12_080
}
