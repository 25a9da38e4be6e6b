//! What a world of `impulse` remembers of its contacts.

use kinetarium_rigid::Settings;
use kinetarium_rigid::impulse::Impulse;
use model::examples::n_pendula;

/// A state of a damaged snapshot may say that it holds more contacts than there is room for: it has as many as there is.
#[test]
fn no_more_contacts_are_remembered_than_there_is_room_for() {
    let model = n_pendula(2).unwrap();
    let impulse = Impulse::new(&model, &Settings::new(1e-3)).unwrap();
    for told in [1e9, f64::INFINITY, f64::NAN, -1.0] {
        let mut state = vec![0.0; impulse.lengths().state];
        state[impulse.memory_places()[0]] = told;
        impulse.fit(&mut state);
        for i in 0..impulse.remembered(&state) {
            impulse.recall(i, &state).contact();
        }
    }
}
