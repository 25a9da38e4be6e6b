// Contacts to lanes, and back.

fn put_contact(field: u32, i: u32, x: f32) {
    contacts[field * plan.contacts + i] = x;
}
fn of_contact(field: u32, i: u32) -> f32 {
    return contacts[field * plan.contacts + i];
}

// The way on which two shapes get through each other. Of it a mesh, which is a surface, has nothing; of two, the smaller
// one has what the box about it has.
fn way_through(a: u32, b: u32) -> f32 {
    let own = solid(SOLID_THICKNESS, a);
    let other = solid(SOLID_THICKNESS, b);
    let smaller = solid(SOLID_RADIUS, a) < solid(SOLID_RADIUS, b);
    let drops_a = is_mesh(a) && !(is_mesh(b) && smaller);
    let drops_b = is_mesh(b) && !(is_mesh(a) && !smaller);
    return select(own, 0.0, drops_a) + select(other, 0.0, drops_b);
}

@compute @workgroup_size(64)
fn seat_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= solved_count()) {
        return;
    }
    let contact = word(plan.contact_order + i);
    let source = contact * REMEMBERED;
    let a = u32(fresh[source + REMEMBERED_SHAPES]);
    let b = u32(fresh[source + REMEMBERED_SHAPES + 1u]);
    seats[i] = carrier_of(a);
    seats[plan.contacts + i] = carrier_of(b);
    for (var x = 0u; x < 3u; x++) {
        put_contact(MANIFOLD_NORMAL + x, i, fresh[source + REMEMBERED_NORMAL + x]);
        put_contact(MANIFOLD_DRAG + x, i, fresh[source + REMEMBERED_DRAG + x]);
        put_contact(MANIFOLD_TWIST + x, i, fresh[source + REMEMBERED_TWIST + x]);
        put_contact(MANIFOLD_DRAG_SUM + x, i, 0.0);
        put_contact(MANIFOLD_TWIST_SUM + x, i, 0.0);
    }
    let surface = surface_of(vec2(a, b));
    // Friction, restitution, torsion, rolling, spring and damper, settling; and what sticks.
    for (var x = 0u; x < 7u; x++) {
        put_contact(MANIFOLD_FRICTION + x, i, constants[surface + x]);
    }
    put_contact(MANIFOLD_STICKING, i, constants[surface + 7u]);
    put_contact(MANIFOLD_THICKNESS, i, way_through(a, b));
    put_contact(MANIFOLD_STRUCK, i, 0.0);
    let count = u32(fresh[source + REMEMBERED_POINTS]);
    for (var p = 0u; p < POINTS; p++) {
        let at = MANIFOLD + p * POINT;
        let is_one = p < count;
        // Points that are not lie where the first does, but far apart: they give nothing.
        let point = source + REMEMBERED_POINT + select(0u, p, is_one) * REMEMBERED_POINT_WIDTH;
        for (var x = 0u; x < 3u; x++) {
            put_contact(at + POINT_ARM_A + x, i, fresh[point + x]);
        }
        put_contact(at + POINT_GAP, i, select(NOWHERE, fresh[point + 3u], is_one));
        put_contact(at + POINT_IMPULSE, i, select(0.0, fresh[point + 5u], is_one));
        put_contact(at + POINT_SUM, i, 0.0);
    }
}

@compute @workgroup_size(64)
fn read_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= solved_count()) {
        return;
    }
    let to = word(plan.contact_order + i) * REMEMBERED;
    for (var x = 0u; x < 3u; x++) {
        fresh[to + REMEMBERED_DRAG + x] = of_contact(MANIFOLD_DRAG + x, i);
        fresh[to + REMEMBERED_TWIST + x] = of_contact(MANIFOLD_TWIST + x, i);
        fresh[to + REMEMBERED_DRAG_SUM + x] = of_contact(MANIFOLD_DRAG_SUM + x, i);
        fresh[to + REMEMBERED_TWIST_SUM + x] = of_contact(MANIFOLD_TWIST_SUM + x, i);
        // What was stopped at its centre of mass is told of by the processor.
        if (of_contact(MANIFOLD_ASIDE + x, i) != 0.0 && runs_on()) {
            stop_in(world_of_contact(word(plan.contact_order + i)), PROCESSOR);
        }
    }
    for (var p = 0u; p < u32(fresh[to + REMEMBERED_POINTS]); p++) {
        let point = to + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH;
        fresh[point + 5u] = of_contact(MANIFOLD + p * POINT + POINT_IMPULSE, i);
        fresh[point + 6u] = of_contact(MANIFOLD + p * POINT + POINT_SUM, i);
    }
}

// Those that press are remembered before all others, as far as there is room; all stay in order.
@compute @workgroup_size(64)
fn find_pressing(@builtin(global_invocation_id) id: vec3<u32>) {
    let place = id.x;
    if (place > plan.contacts) {
        return;
    }
    var presses = false;
    if (place < told_count()) {
        let at = contact_at(place) * REMEMBERED;
        for (var i = 0u; i < 3u; i++) {
            presses = presses || fresh[at + REMEMBERED_DRAG_SUM + i] != 0.0;
        }
        for (var p = 0u; p < u32(fresh[at + REMEMBERED_POINTS]); p++) {
            let point = at + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH;
            presses = presses || fresh[point + 5u] > 0.0 || fresh[point + 6u] > 0.0;
        }
    }
    put(plan.pressing + place, select(0u, 1u, presses));
}

// As which one of its world the contact at a place in the order of all is remembered, or NONE.
fn place_of(world: u32, place: u32) -> u32 {
    let first = first_place(world);
    let base = word(plan.pressing + first);
    let before = word(plan.pressing + place) - base;
    let presses = word(plan.pressing + place + 1u) > before + base;
    let pressing = word(plan.pressing + first_place(world + 1u)) - base;
    let room = plan.remembered - min(pressing, plan.remembered);
    let others = place - first - before;
    if (!presses && others >= room) {
        return NONE;
    }
    let at = before + min(others, room);
    return select(NONE, at, at < plan.remembered);
}
