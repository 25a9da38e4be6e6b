//! From CUDA C++ to PTX, which drivers compile for their card.

use crate::{CudaError, libraries, wgsl};
use cudarc::nvrtc::{CompileError, CompileOptions, Ptx, compile_ptx_with_opts};
use numbers::trace::{PrintOptions, Program};

/// Threads in a block.
pub(crate) const BLOCK: u32 = 64;

/// What is compiled for: what all versions of NVRTC since 12 know, and the drivers of all cards since Turing (2018) take.
/// Kernels of this crate gain nothing from later ones.
const ARCHITECTURE: &str = "compute_75";
/// The same as cards tell it: major and minor compute capability.
pub(crate) const CAPABILITY: (i32, i32) = (7, 5);

/// What NVRTC makes of a text.
pub(crate) fn compile(text: &str) -> Result<Ptx, CudaError> {
    let options = CompileOptions {
        // What the processor rounds twice is rounded twice, and nothing is rounded to less than its bits.
        fmad: Some(false),
        ftz: Some(false),
        prec_div: Some(true),
        prec_sqrt: Some(true),
        arch: Some(ARCHITECTURE),
        ..Default::default()
    };
    compile_ptx_with_opts(text, options).map_err(|error| {
        CudaError::Compile(match error {
            CompileError::CompileError { log, .. } => log.to_string_lossy().into_owned(),
            other => other.to_string(),
        })
    })
}

/// The PTX that cards run for a text of WGSL, to be looked at. Needs NVRTC, but no card.
///
/// # Errors
/// There is no NVRTC; the text has what is not read, or NVRTC does not take it.
pub fn ptx_of_wgsl(text: &str) -> Result<String, CudaError> {
    libraries::find_compiler()?;
    let translated = wgsl::to_cuda(text).map_err(|e| CudaError::Read(e.to_string()))?;
    Ok(compile(&translated.text)?.to_src())
}

/// The PTX that cards run for a record of many worlds with so many numbers of scratch and of state, to be looked at. Needs
/// NVRTC, but no card.
///
/// # Errors
/// There is no NVRTC; it does not take the record.
pub fn ptx(program: &Program, scratch: usize, state: usize) -> Result<String, CudaError> {
    libraries::find_compiler()?;
    let text = program.to_cuda(&PrintOptions {
        workgroup_size: BLOCK,
        pieces: Some(scratch as u32),
        state_pieces: Some(state as u32),
        ..PrintOptions::default()
    });
    Ok(compile(&text)?.to_src())
}
