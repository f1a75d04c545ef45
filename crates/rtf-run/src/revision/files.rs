//! The Git revision of the sources in a directory, read from Git's files: Git may not be
//! installed.

use std::path::{Path, PathBuf};

use rtf_model::Revision;

/// The limit for chains of symbolic references.
const MAX_REFERENCES: usize = 5;

/// Finds the revision that is checked out in a directory or in one above it.
pub fn find(dir: &Path) -> Option<Revision> {
    let find_git = |root: &Path| Some((root.to_owned(), git_dir(&root.join(".git"))?));
    let (root, git) = dir.ancestors().find_map(find_git)?;
    let below_root = dir.strip_prefix(&root).unwrap_or(Path::new(""));
    let of_commit = |commit| Revision {
        commit,
        dir: Some(below_root.to_string_lossy().into_owned()),
        ..Revision::default()
    };
    let head = first_line(&git.join("HEAD"))?;
    let Some(reference) = head.strip_prefix("ref: ") else {
        return commit(&head).map(of_commit);
    };
    let branch = reference.strip_prefix("refs/heads/").map(str::to_owned);
    resolve(&git, reference).map(|commit| Revision { branch, ..of_commit(commit) })
}

/// The branch that was checked out in the repository from which this one was cloned.
pub fn default_branch(dir: &Path) -> Option<String> {
    let git = dir.ancestors().find_map(|root| git_dir(&root.join(".git")))?;
    let head = first_line(&common_dir(&git).join("refs/remotes/origin/HEAD"))?;
    head.strip_prefix("ref: refs/remotes/origin/").map(str::to_owned)
}

/// The Git directory of the repository to which a worktree belongs.
fn common_dir(git: &Path) -> PathBuf {
    let common = first_line(&git.join("commondir"));
    common.map_or_else(|| git.to_owned(), |common| git.join(common))
}

/// The Git directory: `.git` itself, or the target of the file `.git` in a worktree.
fn git_dir(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        return Some(path.to_owned());
    }
    let link = first_line(path)?;
    Some(path.parent()?.join(link.strip_prefix("gitdir: ")?))
}

fn resolve(git: &Path, reference: &str) -> Option<String> {
    let common = common_dir(git);
    let mut reference = reference.to_owned();
    for _ in 0..MAX_REFERENCES {
        let in_worktree = first_line(&git.join(&reference));
        let line = in_worktree.or_else(|| first_line(&common.join(&reference)));
        match line.as_deref().map(|line| (line, line.strip_prefix("ref: "))) {
            Some((_, Some(next))) => reference = next.to_owned(),
            Some((line, None)) => return commit(line),
            None => return find_packed(&common, &reference),
        }
    }
    None
}

fn find_packed(common: &Path, reference: &str) -> Option<String> {
    let text = std::fs::read_to_string(common.join("packed-refs")).ok()?;
    let mut lines = text.lines().filter_map(|line| line.split_once(' '));
    lines.find(|(_, name)| *name == reference).and_then(|(hash, _)| commit(hash))
}

fn commit(hash: &str) -> Option<String> {
    let is_hash = hash.len() >= 40 && hash.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hash.then(|| hash.to_owned())
}

fn first_line(path: &Path) -> Option<String> {
    let text = std::fs::read_to_string(path).ok()?;
    text.lines().next().map(|line| line.trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HASH: &str = "0123456789abcdef0123456789abcdef01234567";

    #[test]
    fn a_branch_a_commit_a_packed_reference_and_a_worktree() {
        let temp = tempfile::tempdir().unwrap();
        let (top, deep) = (temp.path().join("top"), temp.path().join("top/a/b"));
        std::fs::create_dir_all(&deep).unwrap();
        assert_eq!(git_dir(&top.join(".git")), None);
        let write = |name: &str, text: &str| {
            let path = temp.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let found_in = |dir: &str, branch: Option<&str>| {
            let (dir, branch) = (Some(dir.to_owned()), branch.map(str::to_owned));
            Some(Revision { commit: HASH.to_owned(), branch, dir, ..Revision::default() })
        };
        let found = |branch: Option<&str>| found_in("a/b", branch);
        write("top/.git/HEAD", &format!("{HASH}\n"));
        assert_eq!(find(&deep), found(None), "a commit alone");
        write("top/.git/HEAD", "ref: refs/heads/arm/new\n");
        assert_eq!(find(&deep), None, "a branch without a commit");
        write("top/.git/packed-refs", &format!("# pack-refs\n{HASH} refs/heads/arm/new\n"));
        assert_eq!(find(&deep), found(Some("arm/new")));
        write("top/.git/refs/heads/arm/new", &format!("{HASH}\n"));
        assert_eq!(find(&top), found_in("", Some("arm/new")));
        write("tree/.git", "gitdir: ../top/.git/worktrees/tree\n");
        write("top/.git/worktrees/tree/HEAD", "ref: refs/heads/arm/new\n");
        write("top/.git/worktrees/tree/commondir", "../..\n");
        assert_eq!(find(&temp.path().join("tree")), found_in("", Some("arm/new")));
        assert_eq!(default_branch(&deep), None);
        write("top/.git/refs/remotes/origin/HEAD", "ref: refs/remotes/origin/devel/x\n");
        assert_eq!(default_branch(&deep).as_deref(), Some("devel/x"));
        assert_eq!(default_branch(&temp.path().join("tree")).as_deref(), Some("devel/x"));
    }
}
