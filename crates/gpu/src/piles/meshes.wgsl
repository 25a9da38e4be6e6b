// Which triangles of a mesh are near a solid: those whose boxes meet the box about the solid, as the mesh sees it, in the
// order of the mesh.

struct Box {
    low: vec3<f32>,
    high: vec3<f32>,
}

fn turned(q: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}
fn orientation(shape: u32) -> vec4<f32> {
    return vec4(placed3(PLACED_ORIENTATION, shape), of_placed(PLACED_ORIENTATION + 3u, shape));
}

// The box about a solid that is wider by a slack, in the frame of a mesh.
fn seen(solid_shape: u32, mesh: u32, slack: f32) -> Box {
    let q = orientation(mesh);
    let back = vec4(-q.xyz, q.w);
    let apart = placed3(PLACED_POSITION, solid_shape) - placed3(PLACED_POSITION, mesh);
    let center = turned(back, apart);
    var half = vec3(0.0);
    for (var i = 0u; i < 3u; i++) {
        var side = vec3(0.0);
        side[i] = solid(SOLID_EXTENT + i, solid_shape) + slack;
        half += abs(turned(back, turned(orientation(solid_shape), side)));
    }
    let size = abs(center) + half;
    half += 1e-6 * max(size.x, max(size.y, size.z));
    return Box(center - half, center + half);
}

fn meets(around: Box, at: u32) -> bool {
    let low = vec3(constants[at], constants[at + 1u], constants[at + 2u]);
    let high = vec3(constants[at + 3u], constants[at + 4u], constants[at + 5u]);
    return all(around.low <= high) && all(low <= around.high);
}

fn number_of(triangle: u32) -> f32 {
    return constants[plan.mesh_triangles + triangle * TRIANGLE_ROW + TRIANGLE_NUMBER];
}

// Adds a triangle to so many of a pair, which stay in the order of the mesh.
fn insert(list_at: u32, count: u32, triangle: u32) {
    var i = count;
    for (; i > 0u; i--) {
        let before = word(list_at + i - 1u);
        if (number_of(before) < number_of(triangle)) {
            break;
        }
        put(list_at + i, before);
    }
    put(list_at + i, triangle);
}

// Lists the triangles near a solid, and returns how many there are, or more than there is room for.
fn list_near(shapes: vec2<u32>, around: Box, list_at: u32, room: u32) -> u32 {
    var count = 0u;
    let of_shape = plan.mesh_of_shape + 2u * shapes.y;
    for (var group = whole[of_shape]; group < whole[of_shape + 1u]; group++) {
        if (!meets(around, plan.mesh_groups + BOUNDS * group)) {
            continue;
        }
        let clusters = plan.mesh_group_rows + 2u * group;
        for (var cluster = whole[clusters]; cluster < whole[clusters + 1u]; cluster++) {
            if (!meets(around, plan.mesh_clusters + BOUNDS * cluster)) {
                continue;
            }
            let triangles = plan.mesh_cluster_rows + 2u * cluster;
            for (var t = whole[triangles]; t < whole[triangles + 1u]; t++) {
                if (!meets(around, plan.mesh_triangles + t * TRIANGLE_ROW)) {
                    continue;
                }
                if (count == room) {
                    return room + 1u;
                }
                insert(list_at, count, t);
                count++;
            }
        }
    }
    return count;
}

@compute @workgroup_size(64)
fn seat_meshes(@builtin(global_invocation_id) id: vec3<u32>) {
    let seat = id.x;
    first_with_mesh = mesh_first();
    let j = first_with_mesh + seat;
    if (seat >= plan.mesh_pairs || j >= pair_count() || !runs_on()) {
        return;
    }
    let pair = word(plan.pair_order + j);
    let shapes = ordered(pair);
    let places = places_of(pair);
    let room = whole[places + 13u];
    let list_at = plan.near + seat * plan.most_near;
    // As far as the kernels look, so that these are all that they would find.
    let slack = way(shapes) + MARGIN + constants[surface_of(shapes) + SURFACE - 1u];
    let count = list_near(shapes, seen(shapes.x, shapes.y, slack), list_at, room);
    if (count > room) {
        stop(PROCESSOR);
        return;
    }
    for (var side = 0u; side < 2u; side++) {
        // Of the only group, and of its only cluster: everywhere.
        for (var i = 0u; i < BOUNDS; i++) {
            put_parameter(j, whole[places + 14u + side] + i, select(BEYOND, -BEYOND, i < 3u));
        }
    }
    for (var i = 0u; i < room; i++) {
        let to = whole[places + 16u] + i * TRIANGLE;
        if (i >= count) {
            // What meets nothing.
            for (var x = 0u; x < BOUNDS; x++) {
                put_parameter(j, to + x, select(-BEYOND, BEYOND, x < 3u));
            }
            continue;
        }
        let source = plan.mesh_triangles + word(list_at + i) * TRIANGLE_ROW;
        for (var x = 0u; x < TRIANGLE; x++) {
            put_parameter(j, to + x, constants[source + x]);
        }
        let vertices = TRIANGLE_ROW - TRIANGLE;
        for (var x = 0u; x < vertices; x++) {
            put_parameter(j, whole[places + 17u] + i * vertices + x, constants[source + TRIANGLE + x]);
        }
    }
}
