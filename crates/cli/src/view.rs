//! Models in a browser.

use crate::arguments::{Reading, RobotFile, View};
use crate::error::Error;
use crate::output::print;
use crate::robot;
use session::protocol::Values;
use session::{Example, Session, Stage};
use std::net::SocketAddr;
use std::path::Path;
use viewer::{Access, Server, ViewerError, clock, serve};

/// Where the page is, unless something else is there.
const PORT: u16 = 7357;
/// Worlds of a file that are shown at first.
const MOST_SHOWN: usize = 64;

/// Serves a file, an example, or the gallery, until the program is stopped.
pub fn view(arguments: View) -> Result<(), Error> {
    let (port, browser) = (arguments.port, !arguments.no_browser);
    let server = listen(arguments, port)?;
    let url = server.url();
    print(&format!("{url}\nStop with Ctrl+C.\n"));
    let at = server.address();
    if at.ip().is_unspecified() {
        let host = format!("NAME:{}", at.port());
        print(&format!(
            "From elsewhere, with this machine's name or address for NAME: {}\n",
            server.url_at(&host)
        ));
    }
    if browser {
        // Where there is none, the address is what the user needs.
        let _ = open::that_detached(url);
    }
    Ok(server.run()?)
}

fn listen(arguments: View, port: Option<u16>) -> Result<Server, Error> {
    let access = Access::for_address(arguments.address).map_err(ViewerError::from)?;
    let at = |port| SocketAddr::new(arguments.address, port);
    let address = at(port.unwrap_or(PORT));
    // Looked at first, since reading a file for nothing takes longer.
    let taken = std::net::TcpListener::bind(address).is_err();
    let address = if taken && port.is_none() {
        at(0)
    } else {
        address
    };
    let card = arguments.device.open()?;
    let mut made = session(arguments)?;
    if let Some(card) = card {
        made = made.with_card(Ok(card));
    }
    Ok(serve(made, address, access)?)
}

fn session(arguments: View) -> Result<Session, Error> {
    let Some(what) = &arguments.what else {
        return Ok(Session::gallery(clock)?);
    };
    if let Some(name) = example(what) {
        if arguments.worlds.is_some() || arguments.keyframe.is_some() {
            return Err(Error::FilesOnly { name: name.into() });
        }
        return Ok(Session::example(name, clock)?);
    }
    let mut stage = stage(what, &arguments.reading)?;
    if let Some(name) = &arguments.keyframe {
        stage.keyframe = Some(stage.model.keyframe(name)?.clone());
    }
    stage.worlds = arguments.worlds.unwrap_or(stage.worlds);
    stage.shown = stage.worlds.min(MOST_SHOWN);
    Ok(Session::of(stage, clock)?)
}

/// An example by its name, or a robot file.
pub fn stage(what: &Path, reading: &Reading) -> Result<Stage, Error> {
    if let Some(name) = example(what) {
        return Ok(Example::find(name)?.stage(&Values::new())?);
    }
    let file = RobotFile {
        path: what.into(),
        reading: reading.clone(),
    };
    Ok(Stage::loaded(robot::load(&file, false)?))
}

/// A bare word that names no file is an example's name.
pub fn example(what: &Path) -> Option<&str> {
    let bare = what.extension().is_none() && what.components().count() == 1;
    what.to_str().filter(|_| bare && !what.exists())
}
