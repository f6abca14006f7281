//! Page `docs/errors.md`: its messages are those that the commands give.

use amberfield_tests::Workbench;
use std::fmt::Write as _;
use std::path::Path;

/// Root of the repository.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Message of the page, in one line, with the command that makes it and the exit code of its section.
struct Quoted {
    command: Option<String>,
    message: String,
    code: i32,
}

/// Messages of the page: indented lines from `error:` on, up to an empty one.
fn quoted() -> Vec<Quoted> {
    let page = std::fs::read_to_string(root().join("docs/errors.md")).unwrap();
    let (mut all, mut code, mut command) = (Vec::<Quoted>::new(), 0, None);
    let mut is_open = false;
    for line in page.lines() {
        if let Some(rest) = line.strip_prefix("## ") {
            let digits = rest.strip_prefix("Exit code ").unwrap_or("0");
            code = digits.split(':').next().unwrap().parse().unwrap();
        }
        let Some(text) = line.strip_prefix("    ") else {
            is_open = false;
            continue;
        };
        if let Some(words) = text.strip_prefix("$ amberfield ") {
            command = Some(words.to_owned());
        } else if let Some(message) = text.strip_prefix("error: ") {
            all.push(Quoted { command: command.take(), message: message.to_owned(), code });
            is_open = true;
        } else if let Some(words) = command.as_mut().filter(|words| words.ends_with('\\')) {
            words.pop();
            words.push_str(text.trim_start());
        } else if is_open {
            let _ = write!(all.last_mut().unwrap().message, " {text}");
        }
    }
    all
}

/// Whether a text begins with a message in which … stands for any text.
fn begins(text: &str, message: &str) -> bool {
    let mut rest = text;
    message.split('…').enumerate().all(|(number, piece)| match rest.find(piece) {
        Some(place) if number > 0 || place == 0 => {
            rest = &rest[place + piece.len()..];
            true
        }
        _ => false,
    })
}

#[test]
fn commands_of_the_page_give_its_messages() {
    let bench = Workbench::new("");
    std::fs::copy(root().join("crates/cli/templates/bed.toml"), bench.path("bed.toml")).unwrap();
    let columns = "id,x_m,y_m,z_m,radius_m,charge_C\n";
    let first = "1,0.005,0.005,0.005,1e-4,0\n";
    bench.write("broken.toml", "[domain\n");
    bench.write("bare.csv", "id,x,y,z,radius\n1,5,5,5,0.1\n");
    bench.write("twice.csv", format!("{columns}{first}1,0.001,0.005,0.005,1e-4,0\n"));
    bench.write("outside.csv", format!("{columns}1,0.005,0.005,0.5,1e-4,0\n"));
    bench.write("overlap.csv", format!("{columns}{first}2,0.005,0.005,0.00505,1e-4,0\n"));
    assert_eq!(
        bench.run(&["run", "bed.toml", "--threads", "1", "--out", "out", "--steps", "10"]).code,
        Some(0)
    );
    let mut tried = 0;
    for Quoted { command, message, code } in quoted() {
        let Some(command) = command else { continue };
        let answer = bench.run(&command.split(' ').collect::<Vec<_>>());
        let errors: Vec<&str> =
            answer.stderr.lines().filter_map(|line| line.strip_prefix("error: ")).collect();
        assert!(
            errors.first().is_some_and(|error| begins(error, &message)),
            "amberfield {command} says\n{errors:?}, docs/errors.md says\n{message}"
        );
        assert_eq!(answer.code, Some(code), "amberfield {command}");
        tried += 1;
    }
    assert!(tried > 18, "{tried} commands");
}

/// Texts of all source files below a folder, with lines that go on in the next one joined.
fn sources(folder: &Path, into: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let mut lines = text.split("\\\n");
            into.push_str(lines.next().unwrap());
            lines.for_each(|line| into.push_str(line.trim_start()));
        }
    }
}

#[test]
fn messages_that_no_command_of_the_page_makes_stand_in_the_source() {
    let mut source = String::new();
    for entry in std::fs::read_dir(root().join("crates")).unwrap().flatten() {
        let folder = entry.path().join("src");
        if folder.is_dir() {
            sources(&folder, &mut source);
        }
    }
    let messages: Vec<Quoted> = quoted().into_iter().filter(|quoted| quoted.command.is_none()).collect();
    for Quoted { message, .. } in &messages {
        for piece in message.split('…').map(str::trim).filter(|piece| piece.chars().count() > 3) {
            assert!(source.contains(piece), "no source says {piece:?} of docs/errors.md: {message}");
        }
    }
    assert!(messages.len() > 8, "{} messages", messages.len());
}

#[test]
fn pieces_of_a_message_come_in_their_order() {
    assert!(begins("grain 3 left at 5 m", "grain … left at … m") && begins("a b", "a"));
    assert!(!begins("no grain left", "grain") && !begins("left grain", "… grain … left"));
}
