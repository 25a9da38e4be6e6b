//! Records as shaders.

use numbers::trace::{PrintOptions, Program};

/// Parses and validates a shader as wgpu would.
pub fn validate(program: &Program, options: &PrintOptions) {
    let shader = program.to_wgsl(options).unwrap();
    let module = naga::front::wgsl::parse_str(&shader)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader)));
    let flags = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(flags, naga::valid::Capabilities::default())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader)));
}
