//! Shaders, and what they are drawn with.

use super::device::Gpu;
use super::targets::{COLOR, DEPTH, GEOMETRY};

const SOURCE: &str = concat!(
    include_str!("scene.wgsl"),
    include_str!("solids.wgsl"),
    include_str!("geometry.wgsl"),
    include_str!("shadow.wgsl"),
    include_str!("color.wgsl"),
);

#[derive(Debug)]
pub(super) struct Pipelines {
    /// Of a world's numbers and shapes.
    pub world: wgpu::BindGroupLayout,
    /// Of lamps, and of what they see.
    pub lamps: wgpu::BindGroupLayout,
    /// Of a tile that a lamp sees.
    pub onto: wgpu::BindGroupLayout,
    pub geometry: Pair,
    pub shadow: Pair,
    /// With one sample a pixel and with four.
    colors: [Colors; 2],
}

/// For solids, which are drawn as boxes, and for meshes.
#[derive(Debug)]
pub(super) struct Pair {
    pub boxes: wgpu::RenderPipeline,
    pub triangles: wgpu::RenderPipeline,
}

#[derive(Debug)]
pub(super) struct Colors {
    pub background: wgpu::RenderPipeline,
    pub solid: Pair,
    /// What is seen through.
    pub clear: Pair,
}

impl Pipelines {
    pub fn new(gpu: &Gpu) -> Self {
        let [world, lamps, onto] = layouts(gpu);
        let source = wgpu::ShaderSource::Wgsl(SOURCE.into());
        let label = Some("render");
        let shader = wgpu::ShaderModuleDescriptor { label, source };
        let shader = gpu.device.create_shader_module(shader);
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            let descriptor = wgpu::PipelineLayoutDescriptor {
                bind_group_layouts: groups,
                ..Default::default()
            };
            gpu.device.create_pipeline_layout(&descriptor)
        };
        let plain = layout(&[Some(&world)]);
        let lit = layout(&[Some(&world), Some(&lamps)]);
        let from_lamp = layout(&[Some(&world), Some(&onto)]);
        let stage = |layout| Stage {
            gpu,
            shader: &shader,
            layout,
            targets: &[],
            samples: 1,
            compare: wgpu::CompareFunction::Greater,
            writes_depth: true,
        };
        let geometry = GEOMETRY.map(|format| target(format, None));
        let geometry = Stage {
            targets: &geometry,
            ..stage(&plain)
        };
        let shadow = Stage {
            compare: wgpu::CompareFunction::Less,
            ..stage(&from_lamp)
        };
        let colors = |samples| {
            Colors::new(Stage {
                samples,
                ..stage(&lit)
            })
        };
        Self {
            geometry: Pair {
                boxes: geometry.boxes("solid", "solid_geometry"),
                triangles: geometry.triangles("mesh", "mesh_geometry"),
            },
            shadow: Pair {
                boxes: shadow.boxes("solid_in_light", "solid_in_light_depth"),
                // From both sides.
                triangles: shadow.pipeline("mesh_in_light", None, None, &[Some(VERTEX)]),
            },
            colors: [colors(1), colors(4)],
            world,
            lamps,
            onto,
        }
    }

    /// With 1 or 4 samples a pixel.
    pub fn color(&self, samples: u32) -> &Colors {
        &self.colors[usize::from(samples > 1)]
    }
}

impl Colors {
    fn new(stage: Stage) -> Self {
        let pair = |blend, writes_depth| {
            let targets = [target(COLOR, blend)];
            let stage = Stage {
                targets: &targets,
                writes_depth,
                ..stage
            };
            Pair {
                boxes: stage.boxes("solid", "solid_color"),
                triangles: stage.triangles("mesh", "mesh_color"),
            }
        };
        let background = Stage {
            targets: &[target(COLOR, None)],
            compare: wgpu::CompareFunction::Always,
            writes_depth: false,
            ..stage
        };
        Self {
            background: background.pipeline("background", Some("background_color"), None, &[]),
            solid: pair(None, true),
            clear: pair(Some(MIXED), false),
        }
    }
}

/// In front of what is there already, as far as it is opaque.
const MIXED: wgpu::BlendState = wgpu::BlendState::ALPHA_BLENDING;

const VERTEX: wgpu::VertexBufferLayout = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
};

fn target(
    format: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState {
        format,
        blend,
        write_mask: wgpu::ColorWrites::ALL,
    })
}

/// What pipelines for one target have in common.
#[derive(Clone, Copy)]
struct Stage<'a> {
    gpu: &'a Gpu,
    shader: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
    targets: &'a [Option<wgpu::ColorTargetState>],
    samples: u32,
    compare: wgpu::CompareFunction,
    writes_depth: bool,
}

impl Stage<'_> {
    /// The far sides of boxes, which are there when the camera is inside, too.
    fn boxes(&self, vertex: &str, fragment: &str) -> wgpu::RenderPipeline {
        self.pipeline(vertex, Some(fragment), Some(wgpu::Face::Front), &[])
    }
    /// The front of triangles.
    fn triangles(&self, vertex: &str, fragment: &str) -> wgpu::RenderPipeline {
        let culled = Some(wgpu::Face::Back);
        self.pipeline(vertex, Some(fragment), culled, &[Some(VERTEX)])
    }

    fn pipeline(
        &self,
        vertex: &str,
        fragment: Option<&str>,
        cull_mode: Option<wgpu::Face>,
        buffers: &[Option<wgpu::VertexBufferLayout>],
    ) -> wgpu::RenderPipeline {
        let fragment = fragment.map(|entry| wgpu::FragmentState {
            module: self.shader,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets: self.targets,
        });
        let depth = wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(self.writes_depth),
            depth_compare: Some(self.compare),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let descriptor = wgpu::RenderPipelineDescriptor {
            label: Some(vertex),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers,
            },
            primitive: wgpu::PrimitiveState {
                cull_mode,
                ..Default::default()
            },
            depth_stencil: Some(depth),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                ..Default::default()
            },
            fragment,
            multiview_mask: None,
            cache: None,
        };
        self.gpu.device.create_render_pipeline(&descriptor)
    }
}

/// Of a world's numbers and shapes, of lamps and what they see, and of one tile of that.
fn layouts(gpu: &Gpu) -> [wgpu::BindGroupLayout; 3] {
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    };
    let buffer = |ty, has_dynamic_offset| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset,
        min_binding_size: None,
    };
    let layout = |entries: &[wgpu::BindGroupLayoutEntry]| {
        let descriptor = wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries,
        };
        gpu.device.create_bind_group_layout(&descriptor)
    };
    let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let read_only = wgpu::BufferBindingType::Storage { read_only: true };
    let world = layout(&[
        entry(0, both, buffer(wgpu::BufferBindingType::Uniform, true)),
        entry(1, both, buffer(read_only, false)),
    ]);
    let image = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let lamps = layout(&[
        entry(0, fragment, image),
        entry(1, fragment, sampler),
        entry(2, fragment, buffer(read_only, false)),
        entry(3, fragment, buffer(read_only, false)),
    ]);
    let uniform = buffer(wgpu::BufferBindingType::Uniform, true);
    [world, lamps, layout(&[entry(0, both, uniform)])]
}
