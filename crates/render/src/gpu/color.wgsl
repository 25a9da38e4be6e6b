// What light makes of surfaces: the same as in `ray_caster/color.rs`, but for shadows, which are where a
// lamp's picture holds something nearer to it.

struct Lamp {
    // Where it is; where parallel light comes from.
    place: vec3f,
    kind: u32,
    // Where it shines.
    along: vec3f,
    cutoff_cosine: f32,
    color: vec3f,
    exponent: f32,
    attenuation: vec3f,
    // Of its shadows, in `tiles`.
    first_tile: u32,
    tiles: u32,
}

const PARALLEL = 0u;
const POINT = 1u;

@group(1) @binding(0) var shadows: texture_depth_2d;
@group(1) @binding(1) var nearer: sampler_comparison;
@group(1) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(1) @binding(3) var<storage, read> tiles: array<Tile>;

const SHINE = 0.12;
const DARKER = 0.86;
const FLAT = 0.08;

// Which of the six tiles about a lamp shows what is in a direction: +x, −x, +y, −y, +z, −z.
fn side(direction: vec3f) -> u32 {
    let far = abs(direction);
    if far.x >= far.y && far.x >= far.z {
        return select(0u, 1u, direction.x < 0.0);
    }
    if far.y >= far.z {
        return select(2u, 3u, direction.y < 0.0);
    }
    return select(4u, 5u, direction.z < 0.0);
}

// Share of a lamp's light that arrives past everything, the mean of four points about one.
fn passing(lamp: Lamp, p: vec3f, normal: vec3f) -> f32 {
    if lamp.tiles == 0u {
        return 1.0;
    }
    var index = lamp.first_tile;
    if lamp.tiles > 1u {
        index += side(p - lamp.place);
    }
    let tile = tiles[index];
    let depth = (tile.clip * vec4f(p, 1.0)).w;
    let place = tile.clip * vec4f(p + 1.5 * tile.texel * depth * normal, 1.0);
    let on = place.xyz / place.w;
    let at = vec2f(0.5 + 0.5 * on.x, 0.5 - 0.5 * on.y);
    if place.w <= 0.0 || any(at < vec2f(0.0)) || any(at > vec2f(1.0)) {
        return 1.0;
    }
    let texel = 1.0 / vec2f(textureDimensions(shadows));
    // Points beside the edge belong to another tile.
    let low = tile.corner + 2.0 * texel;
    let high = tile.corner + tile.size - 2.0 * texel;
    var light = 0.0;
    for (var i = 0; i < 4; i++) {
        let beside = (vec2f(f32(i & 1), f32(i >> 1)) - 0.5) * texel;
        let uv = clamp(tile.corner + at * tile.size + beside, low, high);
        light += 0.25 * textureSampleCompareLevel(shadows, nearer, uv, clamp(on.z, 0.0, 1.0));
    }
    return light;
}

// What of a lamp's light goes to a distance, at an angle of this cosine to its axis.
fn share(lamp: Lamp, distance: f32, cosine: f32) -> f32 {
    if lamp.kind == PARALLEL {
        return 1.0;
    }
    var spread = 1.0;
    if lamp.kind != POINT {
        spread = select(0.0, pow(max(cosine, 0.0), lamp.exponent), cosine >= lamp.cutoff_cosine);
    }
    return spread / dot(lamp.attenuation, vec3f(1.0, distance, distance * distance));
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
    let p = distance * direction;
    var arriving = mix(world.ground, world.sky, 0.5 + 0.5 * dot(normal, world.up));
    var shine = vec3f(0.0);
    for (var i = 0u; i < u32(world.lamps); i++) {
        let lamp = lamps[u32(world.first_lamp) + i];
        let way = select(lamp.place - p, lamp.place, lamp.kind == PARALLEL);
        let to_lamp = normalize(way);
        let facing = dot(normal, to_lamp);
        let share = share(lamp, length(way), -dot(to_lamp, lamp.along));
        if facing > 0.0 && share > 0.0 {
            let light = share * passing(lamp, p, normal) * lamp.color;
            arriving += facing * light;
            let half_way = normalize(to_lamp - direction);
            shine += SHINE * pow(max(dot(normal, half_way), 0.0), 48.0) * light;
        }
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
