# frozen_string_literal: true

require_relative "driver"

# Cases: named results inside a test.
class CasesTest < HostTest
  TEAR_DOWN = "  def tear_down = report(\"torn down\")\n"

  def test_a_case_has_a_number_parameters_and_a_location
    result, host, = run_body(<<~RUBY)
      self.case("joint 3", joint: 3, side: :left, on: true) { report("moved") }
      report("after")
    RUBY
    assert_equal({ "outcome" => "passed" }, result)
    values = { "joint" => "3", "side" => "left", "on" => "true" }
    start = { "case" => 1, "name" => "joint 3",
              "parameters" => values.map { |name, value| { "name" => name, "value" => value } },
              "location" => { "file" => File.join(@directory, "plugin.rb"), "line" => 4 } }
    assert_equal [start], host.of("case-started")
    assert_equal [["start", 1, "joint 3", nil], ["report", "moved", 1], ["end", 1],
                  ["report", "after", nil]], host.case_events
  end

  ENDS = {
    'require(false, "it moves")' => ["failure", "it moves"],
    'wait_until(0, "x") { false }' => ["failure", "x: not within 0 s (last value: false)"],
    'error("no bench")' => ["error", "no bench"],
    'raise "surprise"' => ["error", "RuntimeError: surprise"],
    "throw 42" => ["error", "UncaughtThrowError: uncaught throw 42"],
    "raise NotImplementedError, 'later'" => ["error", "NotImplementedError: later"]
  }.freeze

  def test_a_problem_ends_the_case_and_the_test_continues
    ENDS.each do |line, (kind, text)|
      result, host, = run_body(<<~RUBY, TEAR_DOWN)
        self.case("one") { #{line}; report("never") }
        self.case("two") { report("on") }
      RUBY
      expected = [["start", 1, "one", nil], [kind, text, 1], ["end", 1], ["start", 2, "two", nil],
                  ["report", "on", 2], ["end", 2], ["report", "torn down", nil]]
      assert_equal expected, host.case_events, line
      assert_equal({ "outcome" => kind == "error" ? "error" : "failed" }, result, line)
    end
  end

  def test_cases_nest
    expected = [["start", 1, "Arm", nil], ["start", 2, "Moves", 1], ["failure", "it moves", 2],
                ["end", 2], ["start", 3, "Stops", 1], ["end", 3], ["report", "here", 1], ["end", 1],
                ["start", 4, "Hand", nil], ["end", 4]]
    assert_equal expected, events_of(<<~RUBY)
      self.case("Arm") do
        self.case("Moves") { require(false, "it moves") }
        self.case("Stops") { nil }
        report("here")
      end
      self.case("Hand") { nil }
    RUBY
  end

  def test_a_body_that_is_left_finishes_its_case
    expected = [["start", 1, "a", nil], ["end", 1], ["start", 2, "b", nil], ["end", 2],
                ["start", 3, "c", nil], ["end", 3], ["report", "torn down", nil]]
    assert_equal expected, events_of(<<~RUBY, TEAR_DOWN)
      self.case("a") { break }
      catch(:out) { self.case("b") { throw :out } }
      self.case("c") { return }
    RUBY
  end

  def test_a_critical_assertion_finishes_its_cases_and_ends_the_test
    expected = [["start", 1, "arm", nil], ["start", 2, "dangerous", 1],
                ["failure", "the arm is free", 2], ["end", 2], ["end", 1],
                ["report", "torn down", nil]]
    assert_equal expected, events_of(<<~RUBY, TEAR_DOWN)
      self.case("arm") { self.case("dangerous") { require_critical(false, "the arm is free") } }
      self.case("never") { nil }
    RUBY
  end

  def test_a_case_outside_of_run_is_an_error_and_its_body_does_not_run
    ["setup(_args)", "tear_down"].each do |step|
      body = "  def #{step}\n    self.case('x') { report('never') }\n    report('on')\n  end\n"
      result, host, = run_body("nil", body)
      assert_equal [["error", "cases are allowed in `run` only"], %w[report on]], host.texts, step
      assert_equal [{ "outcome" => "error" }, []], [result, host.of("case-started")], step
    end
  end

  def test_samples_measurements_and_attachments_belong_to_the_case
    File.write(File.join(@directory, "trace.csv"), "1\n")
    _, host, = run_body(<<~RUBY)
      sample("x", 0)
      self.case("one") do
        sample("x", 1)
        measure("rate", 2)
        attach("trace.csv")
        sample("x", 3)
      end
      sample("x", 4)
    RUBY
    batches = host.of("sampled").map { |one| [one["case"], one["points"].map(&:last)] }
    assert_equal [[nil, [0.0]], [1, [1.0]], [1, [3.0]], [nil, [4.0]]], batches
    assert_equal([1, 1], (host.of("measured") + host.of("attached")).map { |one| one["case"] })
    methods = host.seen.map { |line| line["method"] }.compact - ["phase"]
    assert_equal %w[sampled case-started sampled measured attached sampled case-finished sampled],
                 methods
  end
end
