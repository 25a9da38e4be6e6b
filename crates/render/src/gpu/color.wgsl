// What light makes of surfaces: the same as in `ray_caster/color.rs`, but for shadows, which are where the
// sun's image holds something nearer to the sun.

@group(1) @binding(0) var sun_image: texture_depth_2d;
@group(1) @binding(1) var nearer: sampler_comparison;

const SHINE = 0.12;
const DARKER = 0.86;
const FLAT = 0.08;

// Share of the sun's light that arrives, the mean of four points about one.
fn sunlight(p: vec3f, normal: vec3f) -> f32 {
    if world.texel == 0.0 {
        return 1.0;
    }
    let place = world.sun_clip * vec4f(p + 1.5 * world.texel * normal, 1.0);
    let at = vec2f(0.5 + 0.5 * place.x, 0.5 - 0.5 * place.y);
    if any(at < vec2f(0.0)) || any(at > vec2f(1.0)) {
        return 1.0;
    }
    let corner = vec2f(world.tile_left, world.tile_top);
    let size = vec2f(world.tile_width, world.tile_height);
    let texel = 1.0 / vec2f(textureDimensions(sun_image));
    // Points beside the edge belong to another world.
    let low = corner + 2.0 * texel;
    let high = corner + size - 2.0 * texel;
    var light = 0.0;
    for (var i = 0; i < 4; i++) {
        let beside = (vec2f(f32(i & 1), f32(i >> 1)) - 0.5) * texel;
        let uv = clamp(corner + at * size + beside, low, high);
        light += 0.25 * textureSampleCompareLevel(sun_image, nearer, uv, min(place.z, 1.0));
    }
    return light;
}

fn wave(x: vec2f) -> vec2f {
    return 2.0 * abs(fract(0.5 * x) - 0.5);
}

// Share of a rectangle about a point that odd squares cover.
fn odd_squares(middle: vec2f, size: vec2f) -> f32 {
    let mean = (wave(middle - 0.5 * size) - wave(middle + 0.5 * size)) / size;
    return 0.5 - 0.5 * mean.x * mean.y;
}

fn plane_color(shape: Shape, distance: f32, direction: vec3f, arriving: vec3f) -> vec3f {
    let steep = -dot(direction, shape.y);
    var color = shape.color.rgb * arriving;
    if world.checker > 0.0 {
        let arm = distance * direction - shape.center;
        let p = vec2f(dot(arm, shape.x), dot(arm, shape.z));
        let slant = abs(vec2f(dot(direction, shape.x), dot(direction, shape.z))) / steep;
        let width = distance * world.pixel * (1.0 + slant);
        color *= 1.0 - (1.0 - DARKER) * odd_squares(p / world.checker, width / world.checker);
    }
    if shape.kind == ENDLESS {
        color = mix(world.horizon, color, smoothstep(0.0, FLAT, steep));
    }
    return color;
}

fn surface_color(shape: Shape, distance: f32, direction: vec3f, normal: vec3f) -> vec3f {
    var arriving = mix(world.ground, world.sky, 0.5 + 0.5 * dot(normal, world.up));
    var shine = vec3f(0.0);
    let facing = dot(normal, world.to_sun);
    if facing > 0.0 {
        let sun = sunlight(distance * direction, normal) * world.sun;
        arriving += facing * sun;
        let half_way = normalize(world.to_sun - direction);
        shine = SHINE * pow(max(dot(normal, half_way), 0.0), 48.0) * sun;
    }
    if shape.kind == RECTANGLE || shape.kind == ENDLESS {
        return plane_color(shape, distance, direction, arriving);
    }
    return shape.color.rgb * arriving + shine;
}

// What is brighter than 0.8 is drawn towards 1, which nothing exceeds.
fn drawn(color: vec3f) -> vec3f {
    return select(color, 1.0 - 0.04 / (color - 0.6), color > vec3f(0.8));
}

struct Color {
    @location(0) color: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn solid_color(in: Fragment) -> Color {
    let seen = see_solid(in);
    let color = surface_color(shapes[in.shape], seen.distance, seen.direction, seen.normal);
    return Color(vec4f(drawn(color), shapes[in.shape].color.a), world.near / seen.depth);
}

@fragment
fn mesh_color(in: Fragment) -> Color {
    let seen = see_mesh(in);
    let color = surface_color(shapes[in.shape], seen.distance, seen.direction, seen.normal);
    return Color(vec4f(drawn(color), shapes[in.shape].color.a), world.near / seen.depth);
}

@fragment
fn background_color(in: Fragment) -> @location(0) vec4f {
    let height = max(dot(normalize(in.way), world.up), 0.0);
    let bluer = 1.0 - pow(1.0 - height, 3.0);
    return vec4f(drawn(mix(world.horizon, world.zenith, bluer)), 1.0);
}
