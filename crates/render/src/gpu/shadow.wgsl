// What a lamp sees: pictures of depths, which are tiles of one.

struct Tile {
    // From a position to the tile.
    clip: mat4x4f,
    // Where the lamp is; where parallel light comes from.
    lamp: vec3f,
    parallel: f32,
    // The tile, as shares of the whole picture.
    corner: vec2f,
    size: vec2f,
    // Width of a texel: in metres, or in metres at depth 1 m.
    texel: f32,
}

@group(1) @binding(0) var<uniform> onto: Tile;

@vertex
fn solid_in_light(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> Fragment {
    var out: Fragment;
    out.way = box_corner(vertex, shapes[index]);
    out.place = onto.clip * vec4f(out.way, 1.0);
    out.shape = index;
    return out;
}

@vertex
fn mesh_in_light(@location(0) p: vec3f, @builtin(instance_index) index: u32) -> @builtin(position) vec4f {
    return onto.clip * vec4f(mesh_point(shapes[index], p), 1.0);
}

// A solid that holds a lamp lets its light out.
@fragment
fn solid_in_light_depth(in: Fragment) -> @builtin(frag_depth) f32 {
    let way = select(in.way - onto.lamp, -onto.lamp, onto.parallel > 0.0);
    let direction = normalize(way);
    let met = enter(shapes[in.shape], in.way, direction);
    let p = in.way + met.distance * direction;
    let behind = onto.parallel == 0.0 && dot(p - onto.lamp, direction) <= 0.0;
    if met.distance >= MISS.distance || behind {
        discard;
    }
    let place = onto.clip * vec4f(p, 1.0);
    return place.z / place.w;
}
