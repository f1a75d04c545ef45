# frozen_string_literal: true

require_relative "driver"

# Requests to stop, hangs, crashes and a runner that is gone.
class StoppingTest < HostTest
  TEAR_DOWN = "  def tear_down\n    sleep(0.01)\n    report(\"torn down\")\n  end\n"

  [
    "sleep(1000)",
    "sleep",
    'wait_until(1000, "the end of days") { false }',
    'ask("Does it end?", timeout: 1000)',
    "Kernel.sleep(1000)",
    "nil until interrupted?",
    "Queue.new.pop",
    "input, @output = IO.pipe; system(\"cat\", in: input)",
    "Thread.new { Kernel.sleep }.join",
    "loop {}",
    "loop { begin; Kernel.sleep; rescue Exception => problem; " \
    "@times = @times.to_i + 1; raise if @times > 2; end }"
  ].each_with_index do |waiting, index|
    define_method(:"test_a_request_to_stop_unwinds_the_plugin_and_tears_it_down_#{index}") do
      host = self.host
      host.send("run-test", plugin(arm("report(\"going\"); #{waiting}", TEAR_DOWN)), 2)
      host.wait_for("message")
      host.send("interrupt", { reason: "the simulator collapsed" })
      expected = { "outcome" => "interrupted", "reason" => "the simulator collapsed" }
      assert_equal expected, host.answer["result"], waiting
      assert_equal [%w[report going], ["report", "torn down"]], host.texts, waiting
      assert_predicate host.finish.first, :success?
    end
  end

  def test_a_second_request_ends_a_tear_down_that_waits
    host = self.host
    parking = "  def tear_down\n    report(\"parking\")\n    sleep(1000)\n  end\n"
    host.send("run-test", plugin(arm("", parking)), 2)
    host.wait_for("message")
    host.send("interrupt", { reason: "now" })
    assert_equal({ "outcome" => "interrupted", "reason" => "now" }, host.answer["result"])
  end

  def test_a_failure_before_the_request_to_stop_decides
    host = self.host
    host.send("run-test", plugin(arm("check(false, \"reached\"); sleep(1000)")), 2)
    host.wait_for("message")
    host.send("interrupt", { reason: "Ctrl-C" })
    assert_equal({ "outcome" => "failed" }, host.answer["result"])
  end

  def test_a_request_to_stop_that_comes_before_the_test_is_loaded_is_not_lost
    host = self.host
    host.send("run-test", plugin("$stdin.sync; #{arm("", "  def setup(_) = sleep(1000)\n")}"), 2)
    host.send("interrupt", { reason: "Ctrl-C" })
    assert_equal "interrupted", host.answer["result"]["outcome"]
    refute(host.of("phase").any? { |phase| phase["phase"] == "run" })
  end

  def test_a_request_to_stop_while_nothing_runs_is_forgotten
    host = self.host
    host.send("interrupt", { reason: "too early" })
    assert_equal({ "outcome" => "passed" }, host.ask("run-test", plugin(arm("sleep(0)")))["result"])
  end

  def test_the_stacks_of_all_threads_are_sent
    host = self.host
    body = "Thread.new { Thread.current.name = \"camera\"; sleep }\n" \
           "report(\"going\"); loop {}"
    host.send("run-test", plugin(arm(body)), 2)
    host.wait_for("message")
    # The thread gets its name some time after it was made.
    text = ""
    until text.include?("camera")
      host.send("dump-stack", {})
      text = host.wait_for("stack")["text"]
    end
    assert_match(/\Amain thread \(\w+\)\n  .*plugin\.rb:5:in .*run/, text)
    assert_match(/^thread camera .*\n  .*plugin\.rb:4/, text)
    refute_match(/rtf channel/, text)
  end

  { "Process.kill(:SEGV, Process.pid); Kernel.sleep" => "Segmentation fault",
    "abort(\"oh\")" => "oh", "exit!(3)" => "" }.each_with_index do |(death, said), index|
    define_method(:"test_what_was_told_before_a_death_is_not_lost_#{index}") do
      result, host, status, output = run_body("print(\"printed\"); report(\"told\"); #{death}")
      assert_nil result
      assert_equal [%w[report told]], host.texts
      assert_match(/\Aprinted.*#{said}/m, output)
      refute_predicate status, :success?
    end
  end

  def test_the_host_ends_with_its_runner_while_a_test_runs
    host = self.host
    host.send("run-test", plugin(arm("report(\"going\"); loop {}", TEAR_DOWN)), 2)
    host.wait_for("message")
    host.channel.shutdown(Socket::SHUT_WR)
    assert_equal 1, host.finish.first.exitstatus
    assert_equal [%w[report going]], host.texts
  end

  def test_an_idle_host_ends_in_the_ordinary_way_with_the_channel
    host = self.host
    host.ask("run-test", plugin("at_exit { puts \"bye\" }\n#{arm("")}", is_last: false))
    host.channel.shutdown(Socket::SHUT_WR)
    status, output = host.finish
    assert_equal [0, "bye\n"], [status.exitstatus, output]
  end

  def test_children_have_neither_the_channel_nor_its_name
    body = 'links = IO.popen(["ls", "-l", "/proc/self/fd"], close_others: false, &:read)
check(!links.include?("socket"), links)
check(!ENV.key?("RTF_CHANNEL"), "no name")
check(`echo $RTF_CHANNEL` == "\n", "no name in a child")'
    result, = run_body(body)
    assert_equal({ "outcome" => "passed" }, result)
  end

  def test_a_forked_child_that_comes_back_does_not_answer
    _, host, status, = run_body("child = fork\nProcess.wait(child) if child")
    assert_predicate status, :success?
    assert_equal([1, 2], host.seen.filter_map { |message| message["id"] })
  end
end
