//! `cargo xtask docs`: the documentation as a static site, with the engine in it.

use std::path::{Path, PathBuf};

use anyhow::Result;
use xshell::cmd;

use crate::page::{engine, install};
use crate::workshop::Workshop;

/// Builds the site; returns its folder, which any static host can serve from any path.
pub fn build(workshop: &Workshop) -> Result<PathBuf> {
    workshop.need_program("npm", "npm")?;
    let engine = engine(workshop)?;
    let api = api(workshop)?;
    let site = workshop.target().join("site");
    // What is no page any more would stay.
    workshop.sh.remove_path(&site)?;
    pages(workshop, &engine, &site)?;

    let sh = &workshop.sh;
    let live = sh.create_dir(site.join("live"))?;
    sh.copy_file("web/dist/index.html", live.join("index.html"))?;
    sh.copy_file(engine, live.join("engine.wasm"))?;
    cmd!(sh, "cp -R {api} {site}/api").run()?;
    Ok(site)
}

/// Looks at the finished site in Chromium.
pub fn check(workshop: &Workshop, site: &Path) -> Result<()> {
    workshop.need_program("chromium", "chromium")?;
    let sh = &workshop.sh;
    {
        let _page = sh.push_dir("web");
        install(workshop)?;
    }
    let _docs = sh.push_dir("docs");
    cmd!(sh, "../web/node_modules/.bin/biome check .").run()?;
    Ok(cmd!(sh, "npm run --silent e2e -- {site}").run()?)
}

/// What rustdoc says of the libraries.
fn api(workshop: &Workshop) -> Result<PathBuf> {
    let doc = workshop.target().join("doc");
    // Pages of what is documented no more would stay.
    workshop.sh.remove_path(&doc)?;
    cmd!(
        workshop.sh,
        "cargo doc --quiet --workspace --lib --no-deps --exclude kinetarium-wasm"
    )
    .run()?;
    Ok(doc)
}

/// The pages in Markdown. They take the examples' texts from the engine.
fn pages(workshop: &Workshop, engine: &Path, site: &Path) -> Result<()> {
    let sh = &workshop.sh;
    let _docs = sh.push_dir("docs");
    install(workshop)?;
    Ok(cmd!(sh, "npm run --silent build -- --outDir {site}")
        .env("KINETARIUM_ENGINE", engine)
        .run()?)
}
