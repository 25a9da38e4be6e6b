// Blows: rounds of them in each small step of a step in which any may be. What is launched in a round follows from the one
// before: launches of a round that nothing asks for are empty.

fn launch(number: u32, workgroups: u32) {
    launches[3u * number] = workgroups;
    launches[3u * number + 1u] = 1u;
    launches[3u * number + 2u] = 1u;
}

// The world of the ith contact that is solved.
fn world_of_solved(i: u32) -> u32 {
    return world_of_contact(word(plan.contact_order + i));
}

fn restitution_of(i: u32) -> f32 {
    let at = word(plan.contact_order + i) * REMEMBERED + REMEMBERED_SHAPES;
    let shapes = vec2(u32(fresh[at]), u32(fresh[at + 1u]));
    return constants[surface_of(shapes) + MANIFOLD_RESTITUTION - MANIFOLD_FRICTION];
}

// Which contacts may be struck within the step.
@compute @workgroup_size(64)
fn foresee_blows(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= solved_count()) {
        return;
    }
    let may = of_contact(MANIFOLD_STRUCK, i) > 0.0;
    put(plan.foreseen + i, select(0u, 1u, may));
    if (may) {
        atomicStore(&status[MEETING], 1u);
        atomicStore(&status[of_world(world_of_solved(i), MEETS)], 1u);
        atomicStore(&status[FORESEEN], 1u);
        // The host has not launched any rounds.
        if (told(ROUNDS_OF_BLOWS) == 0u) {
            stop(MORE_BLOWS);
        }
    }
}

// A small step: the first round strikes what was foreseen.
@compute @workgroup_size(64)
fn begin_blows(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i < solved_count()) {
        put_contact(MANIFOLD_STRUCK, i, f32(word(plan.foreseen + i)));
        // Where no blow is foreseen in a world, nothing bounces there in the step.
        let bounces = told(of_world(world_of_solved(i), MEETS)) != 0u;
        put_contact(MANIFOLD_RESTITUTION, i, select(0.0, restitution_of(i), bounces));
    }
    if (i < plan.worlds) {
        atomicStore(&status[of_world(i, STRUCK)], 0u);
    }
    let meets = told(MEETING) != 0u && runs_on();
    if (i < COLOURS) {
        launch(BLOW_COLOUR_RUN + i, select(0u, launches[3u * (COLOUR_RUN + i)], meets));
    }
    if (i == 0u) {
        launch(BLOW_BODIES_RUN, select(0u, (plan.bodies + 63u) / 64u, meets));
        atomicStore(&status[BLOWING], select(0u, 1u, meets));
        atomicStore(&status[ANY_STRUCK], 0u);
        atomicStore(&status[BLOW_ROUND], 0u);
    }
}

// Bodies are parted from what contacts have given before blows, and joined with it after them, which rounds. Those of a
// world without blows, which are parted with the others, have what they had again.
@compute @workgroup_size(64)
fn keep_free(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (is_fixed(body) || body >= plan.bodies) {
        return;
    }
    for (var i = 0u; i < 6u; i++) {
        rows[(ROW + i) * plan.bodies + body] = row(FREE + i, body);
    }
}

@compute @workgroup_size(64)
fn put_free(@builtin(global_invocation_id) id: vec3<u32>) {
    let body = id.x;
    if (is_fixed(body) || body >= plan.bodies || told(of_world(world_of_body(body), MEETS)) != 0u) {
        return;
    }
    for (var i = 0u; i < 6u; i++) {
        rows[(FREE + i) * plan.bodies + body] = row(ROW + i, body);
    }
}

// Whether anything was struck in a world in this round.
fn is_struck(world: u32) -> bool {
    return told(of_world(world, STRUCK)) == told(BLOW_ROUND) + 1u;
}

// In which worlds anything was struck in a round.
@compute @workgroup_size(64)
fn tell_blows(@builtin(global_invocation_id) id: vec3<u32>) {
    if (told(BLOWING) != 0u && id.x < solved_count() && of_contact(MANIFOLD_STRUCK, id.x) > 0.0) {
        atomicStore(&status[ANY_STRUCK], 1u);
        atomicStore(&status[of_world(world_of_solved(id.x), STRUCK)], told(BLOW_ROUND) + 1u);
    }
}

// Then joints of those worlds hand it on; in others the small step's blows are over.
@compute @workgroup_size(64)
fn part_struck(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i < solved_count() && !is_struck(world_of_solved(i))) {
        put_contact(MANIFOLD_RESTITUTION, i, 0.0);
    }
    if (i >= plan.joints) {
        return;
    }
    let struck = is_struck(i % plan.worlds);
    for (var side = 0u; side < 2u; side++) {
        struck_seats[side * plan.joints + i] = select(NONE, joint_body(i, side), struck);
    }
}

// And there is another round.
@compute @workgroup_size(64)
fn end_round(@builtin(local_invocation_index) thread: u32) {
    let struck = told(ANY_STRUCK) != 0u;
    for (var i = thread; i < plan.joint_runs; i += 64u) {
        let joints_of_run = plan.worlds * whole[plan.joint_run + 2u * i + 1u];
        launch(JOINT_RUN + i, select(0u, (joints_of_run + 63u) / 64u, struck));
    }
    if (!struck) {
        launch(BLOW_COLOUR_RUN + thread, 0u);
    }
    storageBarrier();
    if (thread == 0u) {
        let round = told(BLOW_ROUND) + select(0u, 1u, struck);
        atomicStore(&status[BLOW_ROUND], round);
        atomicMax(&status[MOST_BLOWS], round);
        atomicStore(&status[BLOWING], select(0u, 1u, struck));
        atomicStore(&status[ANY_STRUCK], 0u);
        if (struck && round == told(ROUNDS_OF_BLOWS) && round < MOST_ROUNDS_OF_BLOWS) {
            stop(MORE_BLOWS);
        }
    }
}
