//! The workspace's manifests and `deny.toml`, read as text: no cargo, no network.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use toml::{Table, Value};

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("tests/architecture is two folders deep")
        .to_owned()
}

/// The kind of a dependency, by the manifest table that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DependencyKind {
    /// `[dependencies]` and `[build-dependencies]`.
    Normal,
    /// `[dev-dependencies]`.
    Development,
}

/// One entry of a manifest's dependency tables.
#[derive(Debug)]
pub struct Dependency {
    /// The name that code and features use.
    pub key: String,
    /// The name of the package.
    pub package: String,
    pub kind: DependencyKind,
    pub optional: bool,
    pub features: Vec<String>,
}

/// A member of the workspace.
#[derive(Debug)]
pub struct Member {
    /// The last part of its folder, which is its short name.
    pub name: String,
    pub folder: PathBuf,
    pub package: String,
    pub dependencies: Vec<Dependency>,
    features: BTreeMap<String, Vec<String>>,
}

/// All members of the workspace.
#[derive(Debug)]
pub struct Workspace {
    pub members: Vec<Member>,
}

impl Workspace {
    pub fn read() -> Self {
        let root = root();
        let manifest = table(&root.join("Cargo.toml"));
        let workspace = manifest["workspace"].as_table().expect("[workspace]");
        let shared = workspace["dependencies"].as_table().expect("dependencies");
        let mut folders = Vec::new();
        for member in strings(&workspace["members"]) {
            match member.strip_suffix("/*") {
                Some(parent) => {
                    let entries = std::fs::read_dir(root.join(parent)).expect("members' folder");
                    folders.extend(
                        entries
                            .map(|entry| entry.expect("entry").path())
                            .filter(|folder| folder.join("Cargo.toml").is_file()),
                    );
                }
                None => folders.push(root.join(member)),
            }
        }
        folders.sort();
        let members = folders.iter().map(|path| Member::read(path, shared));
        Self {
            members: members.collect(),
        }
    }

    /// The member that a package name belongs to.
    pub fn member(&self, package: &str) -> Option<&Member> {
        self.members.iter().find(|member| member.package == package)
    }

    /// The short names of the members that `member` depends on directly, development included on
    /// request.
    pub fn internal_dependencies<'a>(
        &'a self,
        member: &'a Member,
        development: bool,
    ) -> impl Iterator<Item = &'a str> {
        member
            .dependencies
            .iter()
            .filter(move |dependency| development || dependency.kind == DependencyKind::Normal)
            .filter_map(|dependency| self.member(&dependency.package))
            .map(|dependency| dependency.name.as_str())
    }

    /// The packages outside the workspace that `cargo test --workspace` enables directly, with the
    /// member that does.
    ///
    /// Features start from every member's defaults and spread along dependencies within the
    /// workspace, as cargo's resolver unifies them.
    pub fn default_build(&self) -> BTreeSet<(&str, &str)> {
        let mut enabled: BTreeSet<(&str, String)> = self
            .members
            .iter()
            .map(|member| (member.package.as_str(), "default".to_owned()))
            .collect();
        let mut pending: Vec<(&str, String)> = enabled.iter().cloned().collect();
        for member in &self.members {
            for dependency in member.dependencies.iter().filter(|d| !d.optional) {
                for feature in &dependency.features {
                    pending.push((&dependency.package, feature.clone()));
                }
            }
        }
        while let Some((package, feature)) = pending.pop() {
            let Some(member) = self.member(package) else {
                continue;
            };
            enabled.insert((&member.package, feature.clone()));
            for implied in member.features.get(&feature).into_iter().flatten() {
                let next = match implied.split_once('/') {
                    Some((key, feature)) => {
                        let key = key.trim_end_matches('?');
                        let dependency = member.dependencies.iter().find(|d| d.key == key);
                        dependency.map(|d| (d.package.as_str(), feature.to_owned()))
                    }
                    None => Some((member.package.as_str(), implied.clone())),
                };
                if let Some((package, feature)) = next
                    && !enabled.contains(&(package, feature.clone()))
                {
                    pending.push((package, feature));
                }
            }
        }
        let mut used = BTreeSet::new();
        for member in &self.members {
            for dependency in &member.dependencies {
                let by_feature = [format!("dep:{}", dependency.key), dependency.key.clone()]
                    .into_iter()
                    .any(|feature| enabled.contains(&(member.package.as_str(), feature)));
                if !dependency.optional || by_feature {
                    used.insert((dependency.package.as_str(), member.name.as_str()));
                }
            }
        }
        used
    }
}

impl Member {
    fn read(folder: &Path, shared: &Table) -> Self {
        let manifest = table(&folder.join("Cargo.toml"));
        let mut dependencies = Vec::new();
        let targets = manifest.get("target").and_then(Value::as_table);
        let tables = targets
            .into_iter()
            .flat_map(|targets| targets.values().filter_map(Value::as_table))
            .chain([&manifest]);
        for table in tables {
            for (name, kind) in [
                ("dependencies", DependencyKind::Normal),
                ("build-dependencies", DependencyKind::Normal),
                ("dev-dependencies", DependencyKind::Development),
            ] {
                let entries = table.get(name).and_then(Value::as_table);
                for (key, entry) in entries.into_iter().flatten() {
                    dependencies.push(Dependency::read(key, entry, kind, shared));
                }
            }
        }
        let features = manifest.get("features").and_then(Value::as_table);
        Self {
            name: folder
                .file_name()
                .and_then(|name| name.to_str())
                .expect("a folder's name")
                .to_owned(),
            folder: folder.to_owned(),
            package: manifest["package"]["name"]
                .as_str()
                .expect("package.name")
                .to_owned(),
            dependencies,
            features: features
                .into_iter()
                .flatten()
                .map(|(name, implied)| (name.clone(), strings(implied)))
                .collect(),
        }
    }
}

impl Dependency {
    fn read(key: &str, entry: &Value, kind: DependencyKind, shared: &Table) -> Self {
        let field = |name: &str| {
            let inherited = entry
                .get("workspace")
                .and_then(|_| shared.get(key)?.get(name));
            entry.get(name).or(inherited)
        };
        Self {
            key: key.to_owned(),
            package: field("package")
                .and_then(Value::as_str)
                .unwrap_or(key)
                .to_owned(),
            kind,
            optional: entry.get("optional").and_then(Value::as_bool) == Some(true),
            features: entry.get("features").map(strings).unwrap_or_default(),
        }
    }
}

/// The packages that `deny.toml` confines, each with the packages that may use it.
pub fn confined() -> BTreeMap<String, Vec<String>> {
    let deny = table(&root().join("deny.toml"));
    let bans = deny["bans"]["deny"].as_array().expect("bans.deny");
    let entries = bans.iter().filter_map(|ban| {
        let users = strings(ban.get("wrappers")?);
        Some((ban["crate"].as_str()?.to_owned(), users))
    });
    entries.collect()
}

/// The names of all packages in `Cargo.lock`.
pub fn locked() -> BTreeSet<String> {
    let lock = table(&root().join("Cargo.lock"));
    let packages = lock["package"].as_array().expect("packages");
    let names = packages
        .iter()
        .filter_map(|package| package["name"].as_str());
    names.map(str::to_owned).collect()
}

/// The entry of a crate that may depend on every other.
pub const ANYTHING: &str = "anything";

/// The crates that each crate may depend on, in the order of the table in `ARCHITECTURE.md`.
pub fn allowed_dependencies() -> Vec<(String, Vec<String>)> {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rows = text
        .lines()
        .skip_while(|line| !line.ends_with("| may depend on |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut crates: Vec<(String, Vec<String>)> = Vec::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [names, _, allowed] = cells[..] else {
            panic!("three cells in {row}");
        };
        let names = names
            .split(", ")
            .map(|name| name.trim_matches('`').to_owned());
        let allowed: Vec<String> = match allowed {
            "-" => Vec::new(),
            "all of the above" => crates.iter().map(|(name, _)| name.clone()).collect(),
            list => list
                .split(", ")
                .flat_map(|item| match item.strip_suffix(" and what it uses") {
                    Some(base) => {
                        let used = crates.iter().find(|(name, _)| name == base);
                        let used = used.map(|(_, used)| used.clone()).unwrap_or_default();
                        [vec![base.to_owned()], used].concat()
                    }
                    None => vec![item.to_owned()],
                })
                .collect(),
        };
        crates.extend(names.map(|name| (name, allowed.clone())));
    }
    assert!(!crates.is_empty(), "ARCHITECTURE.md has a table of crates");
    crates
}

pub fn table(path: &Path) -> Table {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.parse()
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn strings(value: &Value) -> Vec<String> {
    let items = value.as_array().expect("an array").iter();
    items
        .map(|item| item.as_str().expect("a string").to_owned())
        .collect()
}
