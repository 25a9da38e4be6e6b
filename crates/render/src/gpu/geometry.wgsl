// Depth, ids and normals.

struct Seen {
    direction: vec3f,
    // Along the ray, and along the optical axis.
    distance: f32,
    depth: f32,
    normal: vec3f,
}

// Discards what is not between near and far.
fn between(seen: Seen) -> Seen {
    if seen.depth <= world.near || seen.depth >= world.far {
        discard;
    }
    return seen;
}

fn see_solid(in: Fragment) -> Seen {
    let direction = normalize(in.way);
    let met = enter(shapes[in.shape], vec3f(0.0), direction);
    if met.distance >= MISS.distance {
        discard;
    }
    let depth = met.distance * dot(direction, world.forward);
    return between(Seen(direction, met.distance, depth, met.normal));
}

fn see_mesh(in: Fragment) -> Seen {
    let distance = length(in.way);
    let depth = dot(in.way, world.forward);
    return between(Seen(in.way / distance, distance, depth, normalize(in.normal)));
}

struct Geometry {
    @location(0) depth: f32,
    // Row of the shape, and of the body.
    @location(1) rows: vec2i,
    @location(2) normal: vec4f,
    @builtin(frag_depth) nearness: f32,
}

fn geometry(in: Fragment, seen: Seen) -> Geometry {
    let shape = shapes[in.shape];
    let normal = vec4f(seen.normal, 0.0);
    return Geometry(seen.depth, vec2i(shape.shape, shape.body), normal, world.near / seen.depth);
}

@fragment
fn solid_geometry(in: Fragment) -> Geometry {
    return geometry(in, see_solid(in));
}

@fragment
fn mesh_geometry(in: Fragment) -> Geometry {
    return geometry(in, see_mesh(in));
}
