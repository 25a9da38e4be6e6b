//! Every fault of a model is refused with a message that names the culprit and the remedy.

mod bodies;
mod builder;
mod common;
mod devices;
mod joints;
mod shapes;
mod whole;
