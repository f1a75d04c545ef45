# frozen_string_literal: true

require_relative "driver"

# Cases on several threads, in forked children, and in a test that is stopped.
class CaseThreadsTest < HostTest
  TEAR_DOWN = "  def tear_down = report(\"torn down\")\n"

  def test_messages_of_other_threads_belong_to_their_own_case_or_that_of_the_test
    expected = [["start", 1, "main", nil], ["start", 2, "thread", nil], ["report", "own", 2],
                ["end", 2], ["report", "without", 1], ["end", 1], ["report", "after", nil]]
    assert_equal expected, events_of(<<~RUBY)
      self.case("main") do
        Thread.new do
          self.case("thread") { report("own") }
          report("without")
        end.join
      end
      Thread.new { report("after") }.join
    RUBY
  end

  def test_many_threads_number_their_cases_in_the_order_of_the_channel
    _, host, = run_body(<<~RUBY)
      work = ->(index) { 50.times { |turn| self.case(index + turn) { report(index + turn) } } }
      8.times.map { |index| Thread.new { work.call(index * 100) } }.each(&:join)
    RUBY
    names = host.of("case-started").to_h { |start| start.values_at("case", "name") }
    assert_equal (1..400).to_a, names.keys
    assert(host.of("message").all? { |one| names[one["case"]] == one["text"] })
    assert_equal (1..400).to_a, host.of("case-finished").map { |one| one["case"] }.sort
  end

  def test_a_forked_child_sends_no_cases
    expected = [["start", 1, "parent", nil], ["report", "in the child", 1],
                ["failure", "it moves", 1], ["report", "after the case", 1], ["end", 1]]
    assert_equal expected, events_of(<<~RUBY)
      self.case("parent") do
        child = fork do
          self.case("inner") { report("in the child"); require(false, "it moves") }
          report("after the case")
          exit!(0)
        end
        Process.wait(child)
      end
    RUBY
  end

  def test_a_stop_request_ends_the_test_and_leaves_the_case_open
    ["sleep(1000)", "Kernel.sleep(1000)", "loop { }"].each do |waiting|
      host = self.host
      body = "self.case('one') { report('going'); #{waiting} }\nself.case('two') { nil }"
      host.send("run-test", plugin(arm(body, TEAR_DOWN)), 2)
      host.wait_for("message")
      host.send("interrupt", { reason: "Ctrl-C" })
      stopped = { "outcome" => "interrupted", "reason" => "Ctrl-C" }
      assert_equal stopped, host.answer["result"], waiting
      expected = [["start", 1, "one", nil], ["report", "going", 1], ["report", "torn down", nil]]
      assert_equal expected, host.case_events, waiting
    end
  end

  def test_a_stopped_test_starts_no_further_case
    host = self.host
    host.send("run-test", plugin(arm(<<~RUBY)), 2)
      self.case("one") do
        report("going")
        nil until interrupted?
      end
      self.case("two") { report("never") }
      report("after")
    RUBY
    host.wait_for("message")
    host.send("interrupt", { reason: "Ctrl-C" })
    assert_equal "interrupted", host.answer["result"]["outcome"]
    assert_equal [["start", 1, "one", nil], ["report", "going", 1], ["report", "after", nil]],
                 host.case_events
  end

  def test_the_end_of_the_process_leaves_the_case_open
    assert_equal [["start", 1, "one", nil]], events_of('self.case("one") { exit(0) }')
  end
end
