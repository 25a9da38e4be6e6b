//! The snippets of the documentation, run as tests.

macro_rules! pages {
    ($($name:ident: $file:literal,)*) => {$(
        #[doc = include_str!(concat!("../../../docs/", $file))]
        struct $name;
    )*};
}

pages! {
    RobotFile: "guide/robot-file.md",
    Worlds: "guide/worlds.md",
    GraphicsCard: "guide/graphics-card.md",
    Controls: "guide/controls.md",
    Building: "guide/building.md",
    Contacts: "guide/contacts.md",
    Events: "guide/events.md",
    Queries: "guide/queries.md",
    Sensors: "guide/sensors.md",
    Snapshots: "guide/snapshots.md",
    Cameras: "guide/cameras.md",
    Kernels: "concepts/kernels.md",
}
