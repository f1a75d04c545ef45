//! Tests with `slots`, which run many episodes of a campaign in one process.

use insta::assert_snapshot;
use rtf_model::protocol::EpisodeSlots;

use crate::bench::Bench;

fn bench() -> Bench {
    let bench = Bench::new();
    for file in ["cell/A.lua", "cell/B.lua"] {
        bench.file(file, "");
    }
    bench
}

#[test]
fn the_limits_of_an_episode_are_planned() {
    let bench = bench();
    let suite = "<suite test-retries='2'><test slots='64' max-steps='500' max-time='1.5s'>A.lua</test></suite>";
    assert_eq!(bench.shown(&suite.replace(" test-retries='2'", "")), "");
    bench.file("cell/s.xml", &suite.replace("test-retries", "retries"));
    let plan = bench.plan(&["s.xml"]);
    let test = &plan.suites[0].tests[0];
    let slots = EpisodeSlots { slots: 64, max_steps: Some(500), max_time_us: Some(1_500_000) };
    assert_eq!((test.slots, test.settings.retries.count), (Some(slots), 0));
}

#[test]
fn all_that_such_a_test_cannot_have_is_reported_at_once() {
    let bench = bench();
    assert_snapshot!(bench.shown(
        "<suite timeout='9s'>
           <test slots='4097' repetition='2' retries='1' isolation='shared' expect='failed'>A.lua
             <matrix name='joint' values='1 2'/>
           </test>
           <test max-steps='5'>B.lua</test>
           <test slots='0'>B.lua</test>
         </suite>"
    ));
    assert_snapshot!(
        bench.shown("<suite><test slots='4'>A.lua</test><test slots='4'>B.lua</test></suite>")
    );
}
