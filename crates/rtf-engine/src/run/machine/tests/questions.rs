//! Questions of tests to an operator.

use insta::assert_snapshot;
use rtf_model::protocol::{Notification, QuestionEnd, Request};
use rtf_model::{
    AnswerChannel, ExitStatus, Phase, Question, Respondent, Source, TestId, Trigger, Verdict,
};

use super::world::{FIXTURE, HOOK, SECOND, TEST, World, hook, suite};
use crate::run::FailLimit;
use crate::run::machine::{
    Deadline, Input, ProcessEvent, QuestionReply, StopLevel, SuiteMachine, TestTimer,
};

fn question(question: u32, default: Option<&str>) -> Question {
    Question {
        question,
        text: "Is it closed?\nLook at the left side.".to_owned(),
        choices: vec!["yes".to_owned(), "no".to_owned()],
        default: default.map(str::to_owned),
        timeout_ms: 60_000,
        ..Question::default()
    }
}

fn ask(world: &mut World<'_>, source: Source, asked: Question) {
    world.input(source, ProcessEvent::Notified(Notification::QuestionAsked(asked)));
}

fn reply(world: &mut World<'_>, question: u32, answer: Option<&str>) {
    let by = Respondent { via: AnswerChannel::Console, who: Some("alice".to_owned()) };
    let answer = answer.map(str::to_owned);
    world.feed(Input::Answer(TestId(0), QuestionReply { question, answer, by }));
}

/// The ends of questions that the host got.
fn ends(world: &World<'_>) -> Vec<QuestionEnd> {
    let end = |request: &Request| match request {
        Request::QuestionClosed(end) => Some(end.clone()),
        _ => None,
    };
    world.sent.iter().filter_map(|(_, _, request)| end(request)).collect()
}

fn answered(question: u32, answer: &str) -> QuestionEnd {
    QuestionEnd { question, answer: Some(answer.to_owned()), problem: None }
}

fn problem(question: u32, problem: &str) -> QuestionEnd {
    QuestionEnd { question, answer: None, problem: Some(problem.to_owned()) }
}

fn finish(world: &mut World<'_>) {
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "passed");
    world.finish();
}

#[test]
fn the_limits_of_a_test_wait_for_an_answer() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    world.now += SECOND;
    ask(&mut world, TEST, question(7, None));
    world.now += 50 * SECOND;
    reply(&mut world, 1, Some("yes"));
    assert_eq!(ends(&world), [answered(7, "yes")]);
    assert_eq!(world.deadlines[&Deadline::Test(TestId(0), TestTimer::Limit)], 55 * SECOND);
    assert_eq!(world.next_deadline(), Deadline::Test(TestId(0), TestTimer::Slow));
    finish(&mut world);
    assert_snapshot!(world.transcript(), @r"
     1.0  question-asked choices=[yes,no] question=1 test=0 text=Is it closed?\nLook at the left side. timeout_ms=60000
    51.0  question-closed answer=yes by={via:console,who:alice} question=1 test=0
    52.0  test-slow test=0
    52.0  test-phase phase=tear-down test=0
    52.0    → close the channel
    52.0  test-finished exit={code:0} phase=exit test=0 verdict=passed
    52.0  suite-finished
    ");
    assert_eq!(world.record.tests[0].attempts[0].questions.len(), 1);
}

#[test]
fn only_the_first_answer_that_is_a_choice_counts() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    ask(&mut world, TEST, question(1, None));
    reply(&mut world, 1, Some("maybe"));
    reply(&mut world, 2, Some("yes"));
    assert_eq!(ends(&world), []);
    reply(&mut world, 1, Some("no"));
    reply(&mut world, 1, Some("yes"));
    assert_eq!(ends(&world), [answered(1, "no")]);
    finish(&mut world);
}

#[test]
fn without_an_answer_the_default_counts_or_it_is_a_problem() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    ask(&mut world, TEST, question(1, Some("no")));
    assert_eq!(world.next_deadline(), Deadline::Test(TestId(0), TestTimer::Question(1)));
    ask(&mut world, TEST, question(2, None));
    world.next_deadline();
    ask(&mut world, TEST, question(3, None));
    reply(&mut world, 3, None);
    ask(&mut world, TEST, question(4, Some("yes")));
    reply(&mut world, 4, None);
    let expected = [
        answered(1, "no"),
        problem(2, "no answer to \"Is it closed?\": no operator answered within 60s"),
        problem(3, "no answer to \"Is it closed?\": declined by alice, on the console"),
        answered(4, "yes"),
    ];
    assert_eq!(ends(&world), expected);
    finish(&mut world);
    let questions = &world.record.tests[0].attempts[0].questions;
    let summaries: Vec<_> =
        questions.iter().map(|it| it.closed.as_ref().unwrap().1.summary()).collect();
    assert_eq!(
        summaries,
        [
            "no (default: no operator answered within 60s)",
            "not answered: no operator answered within 60s",
            "declined (alice, on the console)",
            "yes (default: declined by alice, on the console)",
        ]
    );
}

#[test]
fn a_run_without_a_person_answers_at_once() {
    let plan = suite(0, 1);
    let mut world = World::new(&plan);
    let machine = SuiteMachine::new(&plan, FailLimit::default());
    world.machine = machine.unattended(Some("it is a machine".to_owned()));
    world.start();
    world.phase(TEST, Phase::Run);
    ask(&mut world, TEST, question(1, Some("no")));
    ask(&mut world, TEST, question(2, None));
    let reason = "no answer to \"Is it closed?\": no operator can answer: it is a machine";
    assert_eq!(ends(&world), [answered(1, "no"), problem(2, reason)]);
    finish(&mut world);
}

#[test]
fn a_collapse_ends_a_question_at_once() {
    let plan = suite(1, 1);
    let mut world = World::running(&plan);
    ask(&mut world, TEST, question(1, Some("no")));
    world.now += SECOND;
    world.collapse(FIXTURE, "gone");
    assert_eq!(ends(&world), [], "the host gets the request to stop");
    world.end(TEST, "interrupted");
    assert_snapshot!(world.transcript(), @r"
    0.0  question-asked choices=[yes,no] default=no question=1 test=0 text=Is it closed?\nLook at the left side. timeout_ms=60000
    1.0  fixture-collapsed fixture=0 reason=gone
    1.0  test-stopping cause=collapse reason=fixture `fixture0` collapsed: gone test=0
    1.0  question-closed question=1 reason=fixture `fixture0` collapsed: gone test=0
    1.0    → close the channel
    1.0  test-finished exit={code:0} phase=run reason=fixture `fixture0` collapsed: gone test=0 verdict=collapsed
    1.0  fixture-stopping fixture=0
    ");
}

#[test]
fn every_way_to_stop_a_test_ends_its_questions() {
    for stop in [
        |world: &mut World<'_>| world.stop(StopLevel::TearDown),
        |world: &mut World<'_>| world.stop(StopLevel::Kill),
        |world: &mut World<'_>| world.feed(Input::StopTest(TestId(0), "a user".to_owned())),
        |world: &mut World<'_>| world.feed(Input::Skip("a user".to_owned())),
        |world: &mut World<'_>| world.feed(Input::Deadline(Deadline::Suite)),
        |world: &mut World<'_>| {
            let violation = ProcessEvent::ProtocolViolated("it wrote `x`".to_owned());
            world.input(TEST, violation);
        },
        |world: &mut World<'_>| world.phase(TEST, Phase::TearDown),
        |world: &mut World<'_>| world.answer(TEST, "passed"),
    ] {
        let plan = suite(0, 1);
        let mut world = World::running(&plan);
        ask(&mut world, TEST, question(1, None));
        ask(&mut world, TEST, question(2, Some("no")));
        stop(&mut world);
        let questions = &world.record.tests[0].attempts[0].questions;
        assert!(questions.iter().all(|it| !it.is_open()), "{}", world.transcript());
        assert_eq!(ends(&world), []);
        let limit = Deadline::Test(TestId(0), TestTimer::Limit);
        assert!(world.deadlines.contains_key(&limit), "{:?}", world.deadlines);
        world.next_deadline();
    }
}

#[test]
fn a_question_of_a_stopped_test_is_ignored() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    world.stop(StopLevel::TearDown);
    ask(&mut world, TEST, question(1, None));
    world.end(TEST, "interrupted");
    world.finish();
    assert_eq!(world.record.tests[0].attempts[0].questions, []);
    assert_eq!(world.record.verdict(TestId(0)), Some(Verdict::Interrupted));
}

#[test]
fn a_question_that_nobody_can_answer_is_refused() {
    let plan = suite(0, 1);
    let mut world = World::running(&plan);
    ask(&mut world, TEST, question(1, Some("maybe")));
    for number in 2..=18 {
        ask(&mut world, TEST, question(number, None));
    }
    ask(&mut world, TEST, question(17, None));
    let invalid = "the question \"Is it closed?\" is not valid: \
                   the default answer is none of yes, no";
    let expected = [
        problem(1, invalid),
        problem(18, "more than 16 questions wait for an answer"),
        problem(17, "question 17 is asked twice"),
    ];
    assert_eq!(ends(&world), expected);
    world.phase(TEST, Phase::TearDown);
    ask(&mut world, TEST, question(30, None));
    let late = problem(30, "questions are allowed in `setup` and `run` only");
    assert_eq!(ends(&world).last(), Some(&late));
    world.end(TEST, "passed");
    world.finish();
}

#[test]
fn a_hook_cannot_ask() {
    let mut plan = suite(0, 1);
    plan.hooks = vec![hook(0, &[Trigger::Failure])];
    let mut world = World::running(&plan);
    world.failure(TEST, "no", false);
    world.phase(TEST, Phase::TearDown);
    world.end(TEST, "failed");
    ask(&mut world, HOOK, question(1, Some("no")));
    let refused = "hook `hook0` on failure: a hook cannot ask a question: there may be no operator";
    assert_eq!(ends(&world), [problem(1, crate::hook::ASKED)]);
    world.exit(HOOK, ExitStatus::Code(0));
    world.finish();
    assert_eq!(world.record.hooks[0].problems().next().as_deref(), Some(refused));
}
