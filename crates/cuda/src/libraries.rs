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
