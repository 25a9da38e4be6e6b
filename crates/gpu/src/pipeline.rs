//! From WGSL to what a card runs.

use crate::{Gpu, GpuError};
use numbers::trace::{Members, PrintOptions, Program};
use piles::{Kind, WORKGROUP};

/// How records are printed here.
pub(crate) const OPTIONS: PrintOptions = PrintOptions {
    workgroup_size: WORKGROUP,
    parameters_per_world: false,
    members: Members::Worlds,
    pieces: None,
    state_pieces: None,
    listed: None,
};

impl Gpu {
    /// Compiles a record, or finds what was compiled from the same text.
    pub(crate) fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        self.printed(
            program,
            &PrintOptions {
                parameters_per_world,
                members,
                ..OPTIONS
            },
        )
    }
    /// The same of a record that is printed so.
    pub(crate) fn printed(
        &self,
        program: &Program,
        options: &PrintOptions,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        self.pipeline(&program.to_wgsl(options)?, Some(self.layout()))
    }

    /// Compiles a text, or finds what was compiled from it; with the bindings that it names where none are given.
    pub(crate) fn pipeline(
        &self,
        text: &str,
        bindings: Option<&wgpu::BindGroupLayout>,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let [pipeline] = self.entries(text, [("main", bindings)])?;
        Ok(pipeline)
    }

    /// The same of entry points of one text.
    pub(crate) fn entries<const N: usize>(
        &self,
        text: &str,
        entries: [(&str, Option<&wgpu::BindGroupLayout>); N],
    ) -> Result<[wgpu::ComputePipeline; N], GpuError> {
        let key = (text.to_owned(), entries.map(|(name, _)| name).join(" "));
        if let Some(known) = self.pipelines().get(&key) {
            return Ok(std::array::from_fn(|i| known[i].clone()));
        }
        let compile = || self.compile(text, entries);
        let (compiled, wrong) = self.scoped(wgpu::ErrorFilter::Validation, compile);
        if let Some(wrong) = wrong {
            return Err(self.failed(wrong));
        }
        self.pipelines().insert(key, compiled.to_vec());
        Ok(compiled)
    }

    fn compile<const N: usize>(
        &self,
        text: &str,
        entries: [(&str, Option<&wgpu::BindGroupLayout>); N],
    ) -> [wgpu::ComputePipeline; N] {
        let device = self.device();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("kernel"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        entries.map(|(entry, bindings)| {
            let layout = bindings.map(|bindings| {
                device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    bind_group_layouts: &[Some(bindings)],
                    ..Default::default()
                })
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("kernel"),
                layout: layout.as_ref(),
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        })
    }

    /// Numbers that all invocations of a launch see.
    pub(crate) fn uniform(&self, numbers: &[u32]) -> wgpu::Buffer {
        let buffer = self.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("launch"),
            size: size_of_val(numbers) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bytes = bytemuck::cast_slice(numbers);
        self.queue().write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// Binds buffers in the order of their numbers.
    pub(crate) fn bindings(
        &self,
        layout: &wgpu::BindGroupLayout,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        self.bind(layout, (0..).zip(buffers.iter().copied()))
    }
    /// Binds buffers by their numbers.
    pub(crate) fn bind<'a>(
        &self,
        layout: &wgpu::BindGroupLayout,
        buffers: impl Iterator<Item = (u32, &'a wgpu::Buffer)>,
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        self.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
    }
}

/// Buffers of these numbers and kinds.
pub(crate) fn bind_group_layout(
    device: &wgpu::Device,
    kinds: impl IntoIterator<Item = (u32, Kind)>,
) -> wgpu::BindGroupLayout {
    let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
    let entry = |(binding, kind)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match kind {
                Kind::Written => storage(false),
                Kind::Read => storage(true),
                Kind::Uniform => wgpu::BufferBindingType::Uniform,
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries = Vec::from_iter(kinds.into_iter().map(entry));
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &entries,
    })
}

/// Runs a kernel in so many workgroups.
pub(crate) fn dispatch(
    pass: &mut wgpu::ComputePass<'_>,
    kernel: &wgpu::ComputePipeline,
    bindings: &wgpu::BindGroup,
    workgroups: u32,
) {
    pass.set_pipeline(kernel);
    pass.set_bind_group(0, bindings, &[]);
    pass.dispatch_workgroups(workgroups, 1, 1);
}
