// A step begins and ends: state to rows of bodies, and back.

@compute @workgroup_size(64)
fn clear(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i <= plan.buckets) {
        put_mark(plan.bucket_start + i, 0u);
    }
    if (i <= plan.bodies) {
        put_mark(plan.body_start + i, 0u);
    }
    // What was told of a step that was not taken stays.
    if (i == 0u) {
        // Parts are counted in any case, that the host and the card agree on which this is.
        atomicStore(&status[PART], told(PART) % told(PARTS) + 1u);
    }
    if (i < plan.worlds) {
        atomicStore(&status[of_world(i, TURNED)], 0u);
        atomicStore(&status[of_world(i, WIDEST)], 0u);
        atomicStore(&status[of_world(i, MEETS)], 0u);
        if (told(of_world(i, LEFT)) == 0u) {
            stop_in(i, DONE);
        }
    }
    if (i == 0u) {
        // Where a step was not taken, so that those that follow have no contacts.
        atomicStore(&status[SETTLED], 0u);
    }
    if (i == 0u && runs_on()) {
        atomicStore(&status[ENDED], 0u);
        atomicStore(&status[SUM_ROUND], 0u);
        atomicStore(&status[PAIRS], 0u);
        atomicStore(&status[CONTACTS], 0u);
        atomicStore(&status[CHANGED], 0u);
        atomicStore(&status[ROUND], 0u);
        atomicStore(&status[MEETING], 0u);
        runs[BODIES_RUN] = vec2(plan.worlds, plan.bodies - plan.worlds);
    }
}

@compute @workgroup_size(64)
fn load_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (body >= plan.bodies) {
        return;
    }
    for (var field = 0u; field < ROW; field++) {
        rows[field * plan.bodies + body] = 0.0;
    }
    rows[(ORIENTATION + 3u) * plan.bodies + body] = 1.0;
    if (is_fixed(body)) {
        return;
    }
    let source = state_of(body);
    for (var i = 0u; i < 6u; i++) {
        rows[(VELOCITY + i) * plan.bodies + body] = state[source + STATE_VELOCITY + i];
    }
    for (var i = 0u; i < 7u; i++) {
        rows[place_field(i) * plan.bodies + body] = state[source + i];
    }
    let world = world_of_body(body);
    let within = own_body(body);
    let forces = plan.forces + 6u * world * plan.own_bodies + within;
    for (var i = 0u; i < 6u; i++) {
        rows[(WRENCH + i) * plan.bodies + body] = state[forces + i * plan.own_bodies];
    }
    if (is_first()) {
        let most = constants[world * plan.own_constants + plan.turn + within];
        let turned = length(row3(VELOCITY + 3u, body)) * most;
        atomicMax(&status[of_world(world, TURNED)], bitcast<u32>(turned));
    }
}

// What spins fast has its step cut into parts of equal length; worlds of other parts wait.
fn choose_parts(world: u32) {
    let turned = bitcast<f32>(told(of_world(world, TURNED)));
    var parts = 1u;
    while (parts < plan.small_steps && (plan.small_steps % parts != 0u || !(turned <= f32(parts)))) {
        parts++;
    }
    atomicStore(&status[of_world(world, NEEDED)], parts);
    if (parts != told(PARTS)) {
        stop_in(world, OTHER_PARTS);
    }
}

@compute @workgroup_size(64)
fn load_shapes(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape < plan.worlds && is_first() && runs_in(shape)) {
        choose_parts(shape);
    }
    if (shape >= plan.shapes) {
        return;
    }
    let body = carrier_of(shape);
    for (var i = 0u; i < 19u; i++) {
        var field = VELOCITY + i;
        if (i >= 12u) {
            field = place_field(i - 12u);
        } else if (i >= 6u) {
            field = ACCELERATION + i - 6u;
        }
        shape_scratch[i * plan.shapes + shape] = row(field, body);
    }
}

// What the processor has to take: what got farther than it was looked for, what is lost.

@compute @workgroup_size(64)
fn check_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (is_fixed(body) || body >= plan.bodies) {
        return;
    }
    var sound = true;
    for (var i = 0u; i < 6u; i++) {
        let x = row(VELOCITY + i, body);
        sound = sound && is_finite(x) && abs(x) <= plan.fastest;
    }
    for (var i = 0u; i < 7u; i++) {
        let x = row(CENTER + i, body);
        sound = sound && is_finite(x) && abs(x) <= plan.farthest;
    }
    let world = world_of_body(body);
    if (!sound && runs_in(world)) {
        stop_in(world, PROCESSOR);
    }
}

// No point of a shape gets farther than its body's shift and turn take it. The processor, which takes the step again,
// knows it more closely.
@compute @workgroup_size(64)
fn check_shapes(@builtin(global_invocation_id) id: vec3<u32>) {
    let shape = id.x;
    if (shape >= plan.shapes) {
        return;
    }
    let body = carrier_of(shape);
    if (is_fixed(body) || !runs_in(world_of(shape))) {
        return;
    }
    let source = state_of(body);
    let center = vec3(state[source], state[source + 1u], state[source + 2u]);
    let arm = distance(placed3(PLACED_POSITION, shape), center) + solid(SOLID_RADIUS, shape);
    let way = length(row3(SHIFT, body)) + length(row3(TURN, body)) * arm;
    if (way - of_placed(PLACED_WAY, shape) > solid(SOLID_THICKNESS, shape)) {
        stop_in(world_of(shape), PROCESSOR);
    }
}

@compute @workgroup_size(64)
fn store_bodies(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (is_fixed(body) || body >= plan.bodies || !runs_in(world_of_body(body))) {
        return;
    }
    let to = state_of(body);
    for (var i = 0u; i < 6u; i++) {
        if (is_first()) {
            state[to + STATE_BEFORE + i] = state[to + STATE_VELOCITY + i];
        }
        state[to + STATE_VELOCITY + i] = row(VELOCITY + i, body);
    }
    for (var i = 0u; i < 7u; i++) {
        state[to + i] = row(place_field(i), body);
    }
    // Nothing sleeps here.
    state[to + STATE_REST] = 0.0;
}

@compute @workgroup_size(64)
fn store_contacts(@builtin(global_invocation_id) id: vec3<u32>) {
    let place = id.x;
    if (place >= told_count()) {
        return;
    }
    let contact = contact_at(place);
    let world = world_of_contact(contact);
    if (!runs_in(world)) {
        return;
    }
    let nth = place_of(world, place);
    if (nth == NONE) {
        return;
    }
    let to = memory_of(world, nth);
    for (var i = 0u; i < REMEMBERED; i++) {
        var number = fresh[contact * REMEMBERED + i];
        if (i == REMEMBERED_SHAPES || i == REMEMBERED_SHAPES + 1u) {
            number = f32(own_shape(u32(number)));
        }
        state[to + i] = number;
    }
    colours_before[world * plan.remembered + nth] = mark(plan.colour + contact);
}

@compute @workgroup_size(64)
fn end(@builtin(global_invocation_id) id: vec3<u32>) {
    let world = id.x;
    if (world >= plan.worlds || !runs_in(world)) {
        return;
    }
    let count = first_place(world + 1u) - first_place(world);
    let at = world * plan.state_numbers;
    state[at + plan.count] = f32(min(count, plan.remembered));
    if (count > plan.remembered) {
        state[at + plan.forgotten] += f32(count - plan.remembered);
    }
    if (told(PART) == told(PARTS)) {
        atomicSub(&status[of_world(world, LEFT)], 1u);
    }
    atomicStore(&status[KEEP], 0u);
}
