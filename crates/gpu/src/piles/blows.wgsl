// Blows: rounds of them in each small step of a step in which any may be. What is launched in a round follows from the one
// before: launches of a round that nothing asks for are empty.

fn launch(number: u32, workgroups: u32) {
    launches[3u * number] = workgroups;
    launches[3u * number + 1u] = 1u;
    launches[3u * number + 2u] = 1u;
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
        atomicStore(&status[MEETS], 1u);
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
    }
    let meets = told(MEETS) != 0u && runs_on();
    if (i < COLOURS) {
        launch(BLOW_COLOUR_RUN + i, select(0u, launches[3u * (COLOUR_RUN + i)], meets));
    }
    if (i == 0u) {
        launch(BLOW_BODIES_RUN, select(0u, (plan.bodies + 63u) / 64u, meets));
        atomicStore(&status[BLOWING], select(0u, 1u, meets));
        atomicStore(&status[STRUCK], 0u);
        atomicStore(&status[BLOW_ROUND], 0u);
    }
}

// Whether anything was struck in a round.
@compute @workgroup_size(64)
fn tell_blows(@builtin(global_invocation_id) id: vec3<u32>) {
    if (told(BLOWING) != 0u && id.x < solved_count() && of_contact(MANIFOLD_STRUCK, id.x) > 0.0) {
        atomicStore(&status[STRUCK], 1u);
    }
}

// Then joints hand it on, and there is another round.
@compute @workgroup_size(64)
fn end_round(@builtin(local_invocation_index) thread: u32) {
    let struck = told(STRUCK) != 0u;
    for (var i = thread; i < plan.joint_runs; i += 64u) {
        let joints_of_run = whole[plan.joint_run + 2u * i + 1u];
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
        atomicStore(&status[STRUCK], 0u);
        if (struck && round == told(ROUNDS_OF_BLOWS) && round < MOST_ROUNDS_OF_BLOWS) {
            stop(MORE_BLOWS);
        }
    }
}
