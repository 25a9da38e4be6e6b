// Where a line enters a solid from outside: the same formulas as in the crate `collide`, `ray/line.rs`,
// in single precision.
//
// A line is given from its point nearest to the solid's middle, in the solid's frame, so that far
// cameras cost no digits.

// Distance along the line, and a normal of any length.
struct Entry {
    distance: f32,
    normal: vec3f,
}

const MISS = Entry(1e30, vec3f(0.0));

fn enter_ellipsoid(o: vec3f, d: vec3f, half: vec3f) -> Entry {
    let u = o / half;
    let w = d / half;
    let ww = dot(w, w);
    let middle = -dot(u, w) / ww;
    let foot = u + middle * w;
    let rest = 1.0 - dot(foot, foot);
    if rest < 0.0 {
        return MISS;
    }
    let distance = middle - sqrt(rest / ww);
    return Entry(distance, (o + distance * d) / (half * half));
}

// Entry into x² + z² ≤ r² and exit from it; x > y is a miss.
fn tube(o: vec3f, d: vec3f, r: f32) -> vec2f {
    let ww = max(dot(d.xz, d.xz), 1e-12);
    let middle = -dot(o.xz, d.xz) / ww;
    let foot = o.xz + middle * d.xz;
    let rest = r * r - dot(foot, foot);
    if rest < 0.0 {
        return vec2f(1.0, -1.0);
    }
    let half = sqrt(rest / ww);
    return vec2f(middle - half, middle + half);
}

fn slab(o: f32, d: f32, h: f32) -> vec2f {
    let speed = select(d, select(1e-12, -1e-12, d < 0.0), abs(d) < 1e-12);
    let a = (-h - o) / speed;
    let b = (h - o) / speed;
    return vec2f(min(a, b), max(a, b));
}

// A tube's side where that is between the caps' middles, else the cap on that end.
fn enter_capsule(o: vec3f, d: vec3f, r: f32, h: f32) -> Entry {
    let side = tube(o, d, r);
    if side.x > side.y {
        return MISS;
    }
    let y = o.y + side.x * d.y;
    if abs(y) <= h {
        let p = o + side.x * d;
        return Entry(side.x, vec3f(p.x, 0.0, p.z));
    }
    let middle = vec3f(0.0, select(-h, h, y > 0.0), 0.0);
    return enter_ellipsoid(o - middle, d, vec3f(r));
}

// Between two planes across y, of what a side spans; `normal` is the side's.
fn between_ends(o: vec3f, d: vec3f, h: f32, side: vec2f, normal: vec3f) -> Entry {
    let ends = slab(o.y, d.y, h);
    if max(side.x, ends.x) > min(side.y, ends.y) {
        return MISS;
    }
    if ends.x > side.x {
        return Entry(ends.x, vec3f(0.0, -sign(d.y), 0.0));
    }
    return Entry(side.x, normal);
}

fn enter_cylinder(o: vec3f, d: vec3f, r: f32, h: f32) -> Entry {
    let side = tube(o, d, r);
    if side.x > side.y {
        return MISS;
    }
    let p = o + side.x * d;
    return between_ends(o, d, h, side, vec3f(p.x, 0.0, p.z));
}

fn enter_cone(o: vec3f, d: vec3f, r: f32, h: f32) -> Entry {
    let k = r / (2.0 * h);
    let s = h - o.y;
    let e = -d.y;
    var a = dot(d.xz, d.xz) - k * k * e * e;
    a = select(a, 1e-9, abs(a) < 1e-9);
    let b = dot(o.xz, d.xz) - k * k * s * e;
    let c = dot(o.xz, o.xz) - k * k * s * s;
    let across = s * d.xz - e * o.xz;
    let turn = o.x * d.z - o.z * d.x;
    let square = k * k * dot(across, across) - turn * turn;
    if square < 0.0 && a >= 0.0 {
        return MISS;
    }
    let root = sqrt(max(square, 0.0));
    let q = -(b + select(root, -root, b < 0.0));
    let x = q / a;
    let y = select(c / q, x, q == 0.0);
    let first = min(x, y);
    let last = max(x, y);
    var side = vec2f(first, last);
    if a < 0.0 {
        side = select(vec2f(-1e30, first), vec2f(last, 1e30), e > 0.0);
    }
    let p = o + side.x * d;
    return between_ends(o, d, h, side, vec3f(p.x, k * length(p.xz), p.z));
}

fn enter_box(o: vec3f, d: vec3f, half: vec3f) -> Entry {
    let x = slab(o.x, d.x, half.x);
    let y = slab(o.y, d.y, half.y);
    let z = slab(o.z, d.z, half.z);
    let distance = max(max(x.x, y.x), z.x);
    if distance > min(min(x.y, y.y), z.y) {
        return MISS;
    }
    let last = vec3f(vec3f(x.x, y.x, z.x) == vec3f(distance));
    return Entry(distance, -sign(d) * last);
}

// The upper side of a rectangle in the plane y = 0.
fn enter_rectangle(o: vec3f, d: vec3f, half: vec3f, endless: bool) -> Entry {
    let distance = -o.y / d.y;
    let p = abs(o + distance * d);
    let within = endless || (p.x <= half.x && p.z <= half.z);
    if d.y >= 0.0 || !within {
        return MISS;
    }
    return Entry(distance, vec3f(0.0, 1.0, 0.0));
}

fn enter_solid(shape: Shape, o: vec3f, d: vec3f) -> Entry {
    let r = shape.radius;
    let h = shape.half_height;
    switch shape.kind {
        case SPHERE, ELLIPSOID: { return enter_ellipsoid(o, d, shape.half); }
        case CAPSULE: { return enter_capsule(o, d, r, h - r); }
        case CYLINDER: { return enter_cylinder(o, d, r, h); }
        case CONE: { return enter_cone(o, d, r, h); }
        case BOX: { return enter_box(o, d, shape.half); }
        default: { return enter_rectangle(o, d, shape.half, shape.kind == ENDLESS); }
    }
}

// Along a line through a point: where it enters a shape, from that point, and the unit normal; both along
// the world's axes.
fn enter(shape: Shape, through: vec3f, direction: vec3f) -> Entry {
    let turn = mat3x3f(shape.x, shape.y, shape.z);
    let foot = dot(shape.center - through, direction);
    let nearest = through - shape.center + foot * direction;
    let met = enter_solid(shape, nearest * turn, direction * turn);
    if met.distance == MISS.distance {
        return MISS;
    }
    return Entry(foot + met.distance, normalize(turn * met.normal));
}
