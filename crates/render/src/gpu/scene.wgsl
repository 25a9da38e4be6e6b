// What a world is made of, and where its shapes' boxes and triangles lie in the image.
//
// All positions are from the camera, along the world's axes, so that they keep their digits.

struct World {
    // From a position to the image; depth is near / depth, so that far things keep theirs, too.
    clip: mat4x4f,
    // To depth 1 m: of the image's upper left corner, and of its whole width and height.
    corner: vec3f,
    near: f32,
    right: vec3f,
    far: f32,
    down: vec3f,
    // Width of a sample at depth 1 m.
    pixel: f32,
    forward: vec3f,
    // Edge of the squares on planes; 0 is none.
    checker: f32,
    up: vec3f,
    // Of this world, in `lamps`.
    first_lamp: f32,
    sky: vec3f,
    lamps: f32,
    ground: vec3f,
    zenith: vec3f,
    horizon: vec3f,
}

struct Shape {
    // Its axes in the world.
    x: vec3f,
    radius: f32,
    y: vec3f,
    half_height: f32,
    z: vec3f,
    kind: u32,
    // The middle of its box.
    center: vec3f,
    shape: i32,
    // Half of its box.
    half: vec3f,
    body: i32,
    color: vec4f,
}

const SPHERE = 0u;
const ELLIPSOID = 1u;
const CAPSULE = 2u;
const CYLINDER = 3u;
const CONE = 4u;
const BOX = 5u;
const RECTANGLE = 6u;
const ENDLESS = 7u;
const MESH = 8u;

@group(0) @binding(0) var<uniform> world: World;
@group(0) @binding(1) var<storage, read> shapes: array<Shape>;

struct Fragment {
    @builtin(position) place: vec4f,
    // The point of the box or triangle: the ray goes through it.
    @location(0) @interpolate(perspective, sample) way: vec3f,
    @location(1) @interpolate(flat) shape: u32,
    // Of a triangle, along the world's axes.
    @location(2) @interpolate(flat) normal: vec3f,
}

// Corners of the twelve triangles of a cube, counter-clockwise as seen from outside, a bit for each axis.
const CUBE = array<u32, 36>(
    0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
    2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6,
);

// A triangle that covers the image, at the far end.
fn whole_image(vertex: u32, index: u32) -> Fragment {
    let at = vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0;
    var out: Fragment;
    out.place = vec4f(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
    out.way = world.corner + at.x * world.right + at.y * world.down;
    out.shape = index;
    return out;
}

fn box_corner(vertex: u32, shape: Shape) -> vec3f {
    let corner = CUBE[vertex];
    let side = vec3f(vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u)) * 2.0 - 1.0;
    let arm = side * shape.half;
    return shape.center + arm.x * shape.x + arm.y * shape.y + arm.z * shape.z;
}

@vertex
fn solid(@builtin(vertex_index) vertex: u32, @builtin(instance_index) index: u32) -> Fragment {
    let shape = shapes[index];
    if shape.kind == ENDLESS {
        // The other triangles have no area.
        return whole_image(min(vertex, 2u), index);
    }
    var out: Fragment;
    out.way = box_corner(vertex, shape);
    out.place = world.clip * vec4f(out.way, 1.0);
    out.shape = index;
    return out;
}

fn mesh_point(shape: Shape, p: vec3f) -> vec3f {
    return shape.center + p.x * shape.x + p.y * shape.y + p.z * shape.z;
}

@vertex
fn mesh(
    @location(0) p: vec3f,
    @location(1) normal: vec3f,
    @builtin(instance_index) index: u32,
) -> Fragment {
    let shape = shapes[index];
    var out: Fragment;
    out.way = mesh_point(shape, p);
    out.place = world.clip * vec4f(out.way, 1.0);
    out.shape = index;
    out.normal = normal.x * shape.x + normal.y * shape.y + normal.z * shape.z;
    return out;
}

@vertex
fn background(@builtin(vertex_index) vertex: u32) -> Fragment {
    return whole_image(vertex, 0u);
}

