//! The server: a page, and a WebSocket.

use crate::access::Access;
use crate::client::{LONGEST, attend};
use crate::engine::{Engine, start};
use crate::error::ViewerError;
use crate::viewer::Viewer;
use axum::Router;
use axum::body::Bytes;
use axum::extract::{Query, State, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::get;
use numbers::Float;
use session::Session;
use std::collections::HashMap;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use tokio::net::TcpListener;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;

/// The page, with all it needs.
const PAGE: &str = include_str!("../../../web/dist/index.html");
/// By this the page knows that its engine is a server, not a worker of its own.
const ENGINE: [&str; 2] = [
    r#"name="kinetarium-engine" content="worker""#,
    r#"name="kinetarium-engine" content="websocket""#,
];

/// A server that is ready: it listens, and [`run`](Server::run) answers.
#[derive(Debug)]
pub struct Server {
    engine: Engine,
    session: JoinHandle<()>,
    answering: Answering,
    address: SocketAddr,
    access: Access,
}

/// What a server answers with.
#[derive(Debug)]
struct Answering {
    runtime: Runtime,
    listener: TcpListener,
    router: Router,
}

/// Makes ready to serve a session, whose clock is [`clock`](crate::clock), at an address; port 0 is any that
/// is free.
///
/// # Errors
/// The address cannot be listened at.
pub fn serve<T: Float>(
    session: Session<T>,
    address: SocketAddr,
    access: Access,
) -> Result<Server, ViewerError> {
    let runtime = Builder::new_current_thread().enable_all().build()?;
    let listen = runtime.block_on(TcpListener::bind(address));
    let listener = listen.map_err(|source| ViewerError::Listen { address, source })?;
    let (engine, session) = start(session)?;
    let shared = Shared {
        engine: engine.clone(),
        access: Arc::new(access.clone()),
        page: PAGE.replace(ENGINE[0], ENGINE[1]).into(),
    };
    let router = Router::new()
        .route("/", get(page))
        .route("/session", get(connect))
        .with_state(shared);
    Ok(Server {
        engine,
        session,
        address: listener.local_addr()?,
        answering: Answering {
            runtime,
            listener,
            router,
        },
        access,
    })
}

impl Server {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
    /// What to open in a browser on this machine, with the token, if one is needed.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(Ipv4Addr::LOCALHOST.into());
        }
        self.url_at(&address.to_string())
    }
    /// What to open elsewhere, where `host` is a name and port by which this machine is known there.
    pub fn url_at(&self, host: &str) -> String {
        match self.access.token() {
            Some(token) => format!("http://{host}/?token={token}"),
            None => format!("http://{host}/"),
        }
    }
    /// Answers, until the session is over.
    ///
    /// # Errors
    /// The system takes the socket away.
    pub fn run(self) -> Result<(), ViewerError> {
        Ok(self.answering.run(self.engine.frames)?)
    }
    /// Answers on a thread of its own, until what it returns is closed or dropped, or the session is over.
    ///
    /// # Errors
    /// No thread can be had.
    pub fn in_background(self) -> Result<Viewer, ViewerError> {
        let (address, url) = (self.address, self.url());
        let Engine {
            said,
            frames,
            wardrobe,
        } = self.engine;
        let answer = move || {
            // Nobody is left to be told of a socket that is gone.
            let _ = self.answering.run(frames);
        };
        let answering = thread::Builder::new().name("page".into()).spawn(answer)?;
        let threads = [self.session, answering];
        Ok(Viewer::new(address, url, said, wardrobe, threads))
    }
}

impl Answering {
    /// Answers until the last frame was sent.
    fn run(self, mut frames: watch::Receiver<Bytes>) -> io::Result<()> {
        self.runtime.block_on(async {
            let over = async { while frames.changed().await.is_ok() {} };
            tokio::select! {
                served = axum::serve(self.listener, self.router) => served,
                () = over => Ok(()),
            }
        })
    }
}

#[derive(Clone)]
struct Shared {
    engine: Engine,
    access: Arc<Access>,
    page: Arc<str>,
}

impl Shared {
    /// Why a request may not pass, if it may not.
    fn refusal(&self, headers: &HeaderMap, query: &Parameters) -> Option<Response> {
        let token = query.get("token").map(String::as_str);
        let why = self.access.check(headers, token).err()?;
        Some((StatusCode::FORBIDDEN, why).into_response())
    }
}

type Parameters = HashMap<String, String>;

async fn page(
    State(shared): State<Shared>,
    Query(query): Query<Parameters>,
    headers: HeaderMap,
) -> Response {
    if let Some(refusal) = shared.refusal(&headers, &query) {
        return refusal;
    }
    let fresh = [(header::CACHE_CONTROL, "no-store")];
    (fresh, Html(shared.page.to_string())).into_response()
}

async fn connect(
    State(shared): State<Shared>,
    Query(query): Query<Parameters>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if let Some(refusal) = shared.refusal(&headers, &query) {
        return refusal;
    }
    let engine = shared.engine.clone();
    upgrade
        .max_message_size(LONGEST)
        .max_frame_size(LONGEST)
        .on_upgrade(|socket| attend(socket, engine))
}
