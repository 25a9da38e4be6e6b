//! What bodies wear, as a program wants it, and what pages know of that.

use crate::protocol::{Message, Outfit};
use crate::skin::{Skin, SkinError, SkinFile};
use model::Model;
use parking_lot::Mutex;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Files that a page keeps though no body wears them now, as it may again.
const SPARE: usize = 16;

/// What all bodies wear, as a program wants it: one skin in common, and some their own.
///
/// It is shared between the program and the threads that tell pages. No one waits: each page is told what is new since
/// it was told last, when it has room for a frame. What was put on and off meanwhile it never hears of.
#[derive(Debug)]
pub struct Wardrobe(Mutex<Worn>);

#[derive(Debug)]
struct Worn {
    /// The scene whose bodies these are.
    scene: u32,
    name: String,
    model: Arc<Model>,
    /// Of bodies, by their names: a program may dress thousands at each step.
    rows: HashMap<String, usize>,
    /// Counts the calls that put something on.
    revision: u64,
    /// When it was put on, and what it is.
    common: (u64, Skin),
    own: BTreeMap<usize, (u64, Skin)>,
}

/// What one page has been told of a [`Wardrobe`].
#[derive(Clone, Debug, Default)]
pub struct Told {
    revision: u64,
    /// Files that it has, in the order in which it got them.
    files: Vec<String>,
}

impl Wardrobe {
    /// All bodies of a scene in the colours of their shapes.
    pub(crate) fn new(scene: u32, name: &str, model: &Arc<Model>) -> Self {
        let mut worn = Worn {
            scene,
            name: name.into(),
            model: model.clone(),
            rows: HashMap::new(),
            revision: 0,
            common: (0, Skin::Plain),
            own: BTreeMap::new(),
        };
        worn.meet(model);
        Self(Mutex::new(worn))
    }

    /// Another scene is shown. As on pages, what one body of another model wears is nothing for those of this.
    pub(crate) fn open(&self, scene: u32, name: &str, model: &Arc<Model>) {
        let mut worn = self.0.lock();
        if worn.name != name {
            worn.own.clear();
        }
        (worn.scene, worn.name) = (scene, name.into());
        worn.meet(model);
    }

    /// Has some bodies wear a skin, by their names, until they are dressed again.
    ///
    /// # Errors
    /// A name that no body has; a colour that is none.
    pub fn dress(&self, bodies: &[impl AsRef<str>], skin: Skin) -> Result<(), SkinError> {
        skin.check()?;
        let mut worn = self.0.lock();
        let rows = bodies.iter().map(|name| worn.row(name.as_ref()));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        worn.revision += 1;
        let revision = worn.revision;
        worn.own
            .extend(rows.into_iter().map(|row| (row, (revision, skin.clone()))));
        Ok(())
    }

    /// Has all bodies wear a skin, until they are dressed again; what belongs to the world stays as it is.
    ///
    /// # Errors
    /// A colour that is none.
    pub fn dress_all(&self, skin: Skin) -> Result<(), SkinError> {
        skin.check()?;
        let mut worn = self.0.lock();
        worn.revision += 1;
        worn.common = (worn.revision, skin);
        worn.own.clear();
        Ok(())
    }

    /// Changes whenever a body is dressed.
    pub(crate) fn revision(&self) -> u64 {
        self.0.lock().revision
    }

    /// What a page that shows a scene is to be told, as JSON, and takes note that it was: files that it does not have,
    /// and a [`Message::Dress`]. Nothing where there is nothing new, or where another scene is on its way.
    pub fn news(&self, scene: u32, told: &mut Told) -> Vec<String> {
        let worn = self.0.lock();
        if worn.scene != scene || worn.revision == told.revision {
            return Vec::new();
        }
        let outfits = worn.since(told.revision);
        let files = worn.files();
        told.revision = worn.revision;
        // What follows takes as long as the files are.
        drop(worn);
        let (new, forget) = told.keep(&files);
        let files = new.into_iter().map(|file| Message::SkinFile(file.told()));
        let dress = Message::Dress {
            scene,
            outfits,
            forget,
        };
        files
            .chain([dress])
            .map(|message| message.to_json())
            .collect()
    }
}

impl Worn {
    fn meet(&mut self, model: &Arc<Model>) {
        self.model = model.clone();
        self.rows.clear();
        for (row, body) in model.bodies.iter().enumerate() {
            self.rows.entry(body.name.clone()).or_insert(row);
        }
    }
    fn row(&self, body: &str) -> Result<usize, SkinError> {
        match self.rows.get(body) {
            Some(row) => Ok(*row),
            None => Ok(self.model.body(body)?.0),
        }
    }
    /// What was put on since a revision.
    fn since(&self, revision: u64) -> Vec<Outfit> {
        let mut outfits = Vec::new();
        let (when, common) = &self.common;
        if *when > revision {
            outfits.push(Outfit {
                bodies: None,
                skin: common.told(),
            });
        }
        // What one call has put on is one skin.
        let mut calls = BTreeMap::<u64, (Vec<u32>, &Skin)>::new();
        for (row, (when, skin)) in self.own.range(..self.model.bodies.len()) {
            if *when > revision {
                let call = calls.entry(*when).or_insert((Vec::new(), skin));
                call.0.push(*row as u32);
            }
        }
        outfits.extend(calls.into_values().map(|(bodies, skin)| Outfit {
            bodies: Some(bodies),
            skin: skin.told(),
        }));
        outfits
    }
    /// The files of all skins that are worn, by what tells them apart.
    fn files(&self) -> BTreeMap<String, SkinFile> {
        let own = self.own.values().map(|(_, skin)| skin);
        let files = own.chain([&self.common.1]).filter_map(Skin::file);
        files
            .map(|file| (file.id().to_owned(), file.clone()))
            .collect()
    }
}

impl Told {
    /// Takes note of the files that are worn now; which of them are new, and which the page is to forget: of those that
    /// no body wears, all but the last it got.
    fn keep(&mut self, worn: &BTreeMap<String, SkinFile>) -> (Vec<SkinFile>, Vec<String>) {
        let new: Vec<_> = worn
            .values()
            .filter(|file| !self.files.iter().any(|id| id == file.id()))
            .cloned()
            .collect();
        self.files
            .extend(new.iter().map(|file| file.id().to_owned()));
        let spare = self.files.iter().filter(|id| !worn.contains_key(*id));
        let most = spare.clone().count().saturating_sub(SPARE);
        let forget: Vec<_> = spare.take(most).cloned().collect();
        self.files.retain(|id| !forget.contains(id));
        (new, forget)
    }
}
