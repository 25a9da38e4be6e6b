// Which triangles of a mesh are near a shape: those whose boxes meet the box about the shape, as the mesh sees it, in the
// order of the mesh. Of two meshes, those of A are near that are near those of B.

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

// A box of the world, its middle, axes and half sizes, in the frame of a mesh; and what rounding may take away.
fn seen(center: vec3<f32>, axes: vec4<f32>, half: vec3<f32>, mesh: u32) -> Box {
    let q = orientation(mesh);
    let back = vec4(-q.xyz, q.w);
    let middle = turned(back, center - placed3(PLACED_POSITION, mesh));
    var across = vec3(0.0);
    for (var i = 0u; i < 3u; i++) {
        var side = vec3(0.0);
        side[i] = half[i];
        across += abs(turned(back, turned(axes, side)));
    }
    let size = abs(middle) + across;
    across += 1e-6 * max(size.x, max(size.y, size.z));
    return Box(middle - across, middle + across);
}

// The box about a shape that is wider by a slack.
fn seen_shape(shape: u32, slack: f32, mesh: u32) -> Box {
    var half = vec3(slack);
    for (var i = 0u; i < 3u; i++) {
        half[i] += solid(SOLID_EXTENT + i, shape);
    }
    return seen(placed3(PLACED_POSITION, shape), orientation(shape), half, mesh);
}

// The same of some triangles of a mesh, as far as they are within a box.
fn seen_triangles(list_at: u32, count: u32, within: Box, of_mesh: u32, slack: f32, mesh: u32) -> Box {
    var low = vec3(BEYOND);
    var high = vec3(-BEYOND);
    for (var i = 0u; i < count; i++) {
        let at = plan.mesh_triangles + word(list_at + i) * TRIANGLE_ROW;
        low = min(low, vec3(constants[at], constants[at + 1u], constants[at + 2u]));
        high = max(high, vec3(constants[at + 3u], constants[at + 4u], constants[at + 5u]));
    }
    low = max(low, within.low);
    high = min(high, within.high);
    let axes = orientation(of_mesh);
    let center = placed3(PLACED_POSITION, of_mesh) + turned(axes, 0.5 * (low + high));
    return seen(center, axes, 0.5 * (high - low) + slack, mesh);
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

// Lists the triangles of a mesh in a box, and returns how many there are, or more than there is room for.
fn list_near(mesh: u32, around: Box, list_at: u32, room: u32) -> u32 {
    var count = 0u;
    let of_shape = plan.mesh_of_shape + 2u * own_shape(mesh);
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
    let room = vec2(whole[places + 13u], whole[places + 14u]);
    let list_at = plan.near + 2u * seat * plan.most_near;
    let list_a = list_at + plan.most_near;
    // As far as the kernels look, so that these are all that they would find.
    let slack = way(shapes) + MARGIN + constants[surface_of(shapes) + SURFACE - 1u];
    let around = seen_shape(shapes.x, slack, shapes.y);
    let count = list_near(shapes.y, around, list_at, room.y);
    var count_a = 0u;
    if (room.x > 0u && count > 0u && count <= room.y) {
        let others = seen_triangles(list_at, count, around, shapes.y, slack, shapes.x);
        count_a = list_near(shapes.x, others, list_a, room.x);
    }
    if (count > room.y || count_a > room.x) {
        stop_in(world_of(shapes.x), PROCESSOR);
        return;
    }
    // A group of one cluster for each mesh, which are everywhere.
    let meshes = select(1u, 2u, room.x > 0u);
    for (var table = 0u; table < 2u; table++) {
        for (var i = 0u; i < BOUNDS * meshes; i++) {
            put_parameter(j, whole[places + 15u + table] + i, select(BEYOND, -BEYOND, i % BOUNDS < 3u));
        }
    }
    seat_triangles(j, places, 0u, room.x, list_a, count_a);
    seat_triangles(j, places, room.x, room.y, list_at, count);
}

// So many triangles of a list, in rows from `first` on; what they leave free meets nothing.
fn seat_triangles(j: u32, places: u32, first: u32, room: u32, list_at: u32, count: u32) {
    for (var i = 0u; i < room; i++) {
        let to = whole[places + 17u] + (first + i) * TRIANGLE;
        if (i >= count) {
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
        let corners = whole[places + 18u] + (first + i) * vertices;
        for (var x = 0u; x < vertices; x++) {
            put_parameter(j, corners + x, constants[source + TRIANGLE + x]);
        }
    }
}
