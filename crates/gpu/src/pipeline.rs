//! From a record to what a card runs.

use crate::{Gpu, GpuError};
use numbers::trace::{Program, WgslOptions};

/// Invocations in a workgroup.
pub(crate) const WORKGROUP: u32 = 64;

/// Compiles a record, or finds what was compiled from the same text.
pub(crate) fn pipeline(
    gpu: &Gpu,
    program: &Program,
    parameters_per_world: bool,
) -> Result<wgpu::ComputePipeline, GpuError> {
    let options = WgslOptions {
        workgroup_size: WORKGROUP,
        parameters_per_world,
    };
    let text = program.to_wgsl(&options)?;
    if let Some(known) = gpu.pipelines().get(&text) {
        return Ok(known.clone());
    }
    let (compiled, wrong) = gpu.scoped(wgpu::ErrorFilter::Validation, || compile(gpu, &text));
    if let Some(wrong) = wrong {
        return Err(gpu.failed(wrong));
    }
    gpu.pipelines().insert(text, compiled.clone());
    Ok(compiled)
}

fn compile(gpu: &Gpu, text: &str) -> wgpu::ComputePipeline {
    let device = gpu.device();
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("kernel"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        bind_group_layouts: &[Some(gpu.layout())],
        ..Default::default()
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("kernel"),
        layout: Some(&layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    })
}
