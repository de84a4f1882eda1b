//! The import graph of every crate: which file names items of which other file.
//!
//! The graph comes from the syntax tree. Imports, paths in code and paths in macro arguments are
//! resolved through re-exports to the file that defines the item. Items under `#[cfg(test)]` are
//! left out. A re-export (`pub use`) alone is no edge: it gives a name, it needs nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::spanned::Spanned;
use syn::visit::Visit;
use syn::{Attribute, Item, UseTree, Visibility};

use crate::manifests::{Workspace, root};

/// A production source file: one that a crate root reaches without `#[cfg(test)]`.
#[derive(Debug)]
pub struct SourceFile {
    /// The short name of its crate.
    pub krate: String,
    /// Relative to the root of the repository.
    pub path: PathBuf,
    /// The folder whose modules may import each other freely: `a/` for `a.rs`, `a/mod.rs` and
    /// `a/b.rs`.
    pub folder: PathBuf,
    /// Lines of code: neither blank, nor comment, nor under `#[cfg(test)]`.
    pub code_lines: usize,
    /// Names of the structs, enums, unions and traits that the file defines.
    pub types: Vec<String>,
    /// Indices of the files that this one needs.
    pub imports: BTreeSet<usize>,
}

/// All production files of the workspace.
#[derive(Debug, Default)]
pub struct Sources {
    pub files: Vec<SourceFile>,
    modules: Vec<Module>,
    /// The library root of every crate, by the name that code uses.
    libraries: BTreeMap<String, usize>,
}

#[derive(Debug, Default)]
struct Module {
    file: usize,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
    /// Names brought in by `use`, with the path that they stand for.
    imported: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    /// Names of items that the module defines itself.
    defined: BTreeSet<String>,
    /// Paths that the module needs: private imports and paths in code.
    needed: BTreeSet<Vec<String>>,
}

/// The names that were looked for in a module's glob imports, so that globs in a circle end.
type Tried = BTreeSet<(usize, String)>;

/// The longest path of a resolution; longer ones go in a circle.
const MAX_SEGMENTS: usize = 32;

/// The target of a path.
enum Target {
    Module,
    /// An item of the file.
    Item(usize),
}

impl Sources {
    pub fn read() -> Self {
        let mut sources = Self::default();
        for member in Workspace::read().members {
            if member.folder.starts_with(root().join("tests")) {
                continue;
            }
            let mut roots = vec![member.folder.join("build.rs")];
            roots.extend(["lib.rs", "main.rs"].map(|name| member.folder.join("src").join(name)));
            if let Ok(programs) = std::fs::read_dir(member.folder.join("src/bin")) {
                roots.extend(programs.map(|entry| entry.expect("entry").path()));
            }
            for path in roots.into_iter().filter(|path| path.is_file()) {
                let is_library = path.ends_with("lib.rs");
                let root = sources.add_file(&member.name, &path, None, true);
                if is_library {
                    let name = member.name.replace('-', "_");
                    sources.libraries.insert(name, root);
                }
            }
        }
        sources.connect();
        sources
    }

    /// Files in import cycles that span folders, one set for each cycle.
    pub fn cycles_across_folders(&self) -> Vec<Vec<&SourceFile>> {
        let cycles = self.cycles().into_iter();
        let across = cycles.filter(|cycle| cycle.iter().any(|f| f.folder != cycle[0].folder));
        across.collect()
    }

    /// Files in import cycles, one set for each cycle (strongly connected component).
    pub fn cycles(&self) -> Vec<Vec<&SourceFile>> {
        let reached: Vec<BTreeSet<usize>> = (0..self.files.len())
            .map(|file| self.reached_from(file))
            .collect();
        let mut assigned = BTreeSet::new();
        let mut cycles = Vec::new();
        for file in 0..self.files.len() {
            let cycle: Vec<usize> = reached[file]
                .iter()
                .copied()
                .filter(|&other| reached[other].contains(&file))
                .collect();
            if cycle.len() > 1 && assigned.insert(cycle[0]) {
                cycles.push(cycle.into_iter().map(|index| &self.files[index]).collect());
            }
        }
        cycles
    }

    /// The files that a file needs, directly or through others, with itself only if it is in a
    /// cycle.
    pub fn reached_from(&self, file: usize) -> BTreeSet<usize> {
        let mut reached = BTreeSet::new();
        let mut pending = vec![file];
        while let Some(next) = pending.pop() {
            for &import in &self.files[next].imports {
                if reached.insert(import) {
                    pending.push(import);
                }
            }
        }
        reached
    }

    /// The index of the file whose path ends so.
    pub fn find(&self, end: &str) -> Option<usize> {
        self.files.iter().position(|file| file.path.ends_with(end))
    }

    fn add_file(
        &mut self,
        krate: &str,
        path: &Path,
        parent: Option<usize>,
        root_file: bool,
    ) -> usize {
        let text = std::fs::read_to_string(path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let syntax =
            syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let parent_folder = path.parent().expect("a file has a folder");
        let children_folder = if root_file || path.ends_with("mod.rs") {
            parent_folder.to_owned()
        } else {
            path.with_extension("")
        };
        let folder = if children_folder.is_dir() {
            &children_folder
        } else {
            parent_folder
        };
        let relative = |path: &Path| path.strip_prefix(root()).expect("inside").to_owned();
        let mut types = TypeNames::default();
        types.visit_file(&syntax);
        let file = self.files.len();
        self.files.push(SourceFile {
            krate: krate.to_owned(),
            path: relative(path),
            folder: relative(folder),
            code_lines: code_lines(&text, &types.test_lines),
            types: types.names,
            imports: BTreeSet::new(),
        });
        let module = self.new_module(file, parent);
        self.add_items(module, &syntax.items, krate, &children_folder);
        module
    }

    fn new_module(&mut self, file: usize, parent: Option<usize>) -> usize {
        self.modules.push(Module {
            file,
            parent,
            ..Module::default()
        });
        self.modules.len() - 1
    }

    fn add_items(&mut self, module: usize, items: &[Item], krate: &str, children_folder: &Path) {
        for item in items {
            if is_test(attributes(item)) {
                continue;
            }
            match item {
                Item::Mod(child) => {
                    let name = child.ident.to_string();
                    let folder = children_folder.join(&name);
                    let index = if let Some((_, items)) = &child.content {
                        let index = self.new_module(self.modules[module].file, Some(module));
                        self.add_items(index, items, krate, &folder);
                        index
                    } else {
                        let file = [folder.with_extension("rs"), folder.join("mod.rs")]
                            .into_iter()
                            .find(|path| path.is_file())
                            .unwrap_or_else(|| panic!("no file for module {}", folder.display()));
                        self.add_file(krate, &file, Some(module), false)
                    };
                    self.modules[module].children.insert(name, index);
                }
                Item::Use(import) => {
                    let private = matches!(import.vis, Visibility::Inherited);
                    self.modules[module].add_use(&import.tree, &mut Vec::new(), private);
                }
                item => {
                    let module = &mut self.modules[module];
                    module.defined.extend(defined_name(item));
                    Paths { module }.visit_item(item);
                }
            }
        }
    }

    /// Resolves the paths that every module needs to edges between files.
    fn connect(&mut self) {
        for module in 0..self.modules.len() {
            let file = self.modules[module].file;
            let targets: Vec<usize> = self.modules[module]
                .needed
                .iter()
                .filter_map(
                    |path| match self.resolve(module, path, &mut Tried::new())? {
                        Target::Item(target) => Some(target),
                        Target::Module => None,
                    },
                )
                .filter(|&target| target != file)
                .collect();
            self.files[file].imports.extend(targets);
        }
    }

    /// Follows a path from a module, through re-exports, to where it leads within the workspace.
    fn resolve(&self, from: usize, path: &[String], tried: &mut Tried) -> Option<Target> {
        if path.len() > MAX_SEGMENTS {
            return None;
        }
        let (first, rest) = path.split_first()?;
        let start = match first.as_str() {
            "crate" => {
                let mut module = from;
                while let Some(parent) = self.modules[module].parent {
                    module = parent;
                }
                module
            }
            "self" => from,
            "super" => self.modules[from].parent?,
            name => match self.resolve_name(from, name, rest, tried) {
                Some(target) => return Some(target),
                None => *self.libraries.get(name)?,
            },
        };
        self.resolve_within(start, rest, tried)
    }

    fn resolve_within(&self, module: usize, path: &[String], tried: &mut Tried) -> Option<Target> {
        match path.split_first() {
            None => Some(Target::Module),
            Some((first, rest)) if first == "super" => {
                self.resolve_within(self.modules[module].parent?, rest, tried)
            }
            Some((first, rest)) => self.resolve_name(module, first, rest, tried),
        }
    }

    fn resolve_name(
        &self,
        from: usize,
        name: &str,
        rest: &[String],
        tried: &mut Tried,
    ) -> Option<Target> {
        let module = &self.modules[from];
        if let Some(&child) = module.children.get(name) {
            return self.resolve_within(child, rest, tried);
        }
        if module.defined.contains(name) {
            return Some(Target::Item(module.file));
        }
        if let Some(path) = module.imported.get(name) {
            let full: Vec<String> = path.iter().chain(rest).cloned().collect();
            // `use toml::toml`: the first segment is a crate.
            if path[0] == name {
                let library = *self.libraries.get(name)?;
                return self.resolve_within(library, &full[1..], tried);
            }
            return self.resolve(from, &full, tried);
        }
        if !tried.insert((from, name.to_owned())) {
            return None;
        }
        module.globs.iter().find_map(|glob| {
            let name = name.to_owned();
            let full: Vec<String> = glob.iter().chain([&name]).chain(rest).cloned().collect();
            self.resolve(from, &full, tried)
        })
    }
}

impl Module {
    fn add_use(&mut self, tree: &UseTree, prefix: &mut Vec<String>, private: bool) {
        match tree {
            UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                self.add_use(&path.tree, prefix, private);
                prefix.pop();
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.add_use(tree, prefix, private);
                }
            }
            UseTree::Glob(_) => self.globs.push(prefix.clone()),
            UseTree::Name(name) => {
                let name = name.ident.to_string();
                let mut path = prefix.clone();
                let alias = if name == "self" {
                    path.last().cloned().unwrap_or_default()
                } else {
                    path.push(name.clone());
                    name
                };
                self.add_import(alias, path, private);
            }
            UseTree::Rename(rename) => {
                let mut path = prefix.clone();
                if rename.ident != "self" {
                    path.push(rename.ident.to_string());
                }
                self.add_import(rename.rename.to_string(), path, private);
            }
        }
    }

    fn add_import(&mut self, alias: String, path: Vec<String>, private: bool) {
        if private {
            self.needed.insert(path.clone());
        }
        // Traits are imported as `_`, too.
        if alias != "_" {
            self.imported.insert(alias, path);
        }
    }
}

/// Collects the paths of an item's code, those in macro arguments included.
struct Paths<'a> {
    module: &'a mut Module,
}

impl Paths<'_> {
    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.module.needed.insert(std::mem::take(&mut path));
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => {
                    self.module.needed.insert(std::mem::take(&mut path));
                    colons = 0;
                    // Attributes within macros hold no paths.
                    if group.delimiter() != Delimiter::Bracket || !group.stream().is_empty() {
                        self.add_tokens(group.stream());
                    }
                }
                TokenTree::Punct(_) | TokenTree::Literal(_) => {
                    self.module.needed.insert(std::mem::take(&mut path));
                    colons = 0;
                }
            }
        }
        self.module.needed.insert(path);
    }
}

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments = path.segments.iter().map(|s| s.ident.to_string());
        self.module.needed.insert(segments.collect());
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.add_tokens(call.tokens.clone());
        syn::visit::visit_macro(self, call);
    }

    /// An import within a function serves the module's other functions as well: names seldom clash.
    fn visit_item_use(&mut self, import: &'ast syn::ItemUse) {
        self.module.add_use(&import.tree, &mut Vec::new(), true);
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_impl_item(&mut self, item: &'ast syn::ImplItem) {
        let attributes = match item {
            syn::ImplItem::Fn(function) => &function.attrs,
            syn::ImplItem::Const(constant) => &constant.attrs,
            _ => &Vec::new(),
        };
        if !is_test(attributes) {
            syn::visit::visit_impl_item(self, item);
        }
    }
}

/// Collects the names of types outside tests, and the lines of tests.
#[derive(Default)]
struct TypeNames {
    names: Vec<String>,
    /// First and last line of every item under `#[cfg(test)]`, from 1.
    test_lines: Vec<(usize, usize)>,
}

impl<'ast> Visit<'ast> for TypeNames {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_test(attributes(item)) {
            let span = item.span();
            self.test_lines.push((span.start().line, span.end().line));
            return;
        }
        if let Item::Struct(_) | Item::Enum(_) | Item::Union(_) | Item::Trait(_) = item {
            self.names.extend(defined_name(item));
        }
        syn::visit::visit_item(self, item);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        if is_test(&function.attrs) {
            let span = function.span();
            self.test_lines.push((span.start().line, span.end().line));
        } else {
            syn::visit::visit_impl_item_fn(self, function);
        }
    }
}

/// Whether an item is under `#[cfg(test)]` or the like.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.meta.require_list().is_ok_and(|list| {
                let condition = list.tokens.to_string();
                condition == "test" || condition.starts_with("all (test")
            })
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn defined_name(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}

/// Counts lines that are neither blank, nor comment, nor within the given ranges.
fn code_lines(text: &str, left_out: &[(usize, usize)]) -> usize {
    let lines = text.lines().enumerate().filter(|(index, line)| {
        let line = line.trim();
        let in_range = |(first, last): &(usize, usize)| (*first..=*last).contains(&(index + 1));
        !line.is_empty() && !line.starts_with("//") && !left_out.iter().any(in_range)
    });
    lines.count()
}
