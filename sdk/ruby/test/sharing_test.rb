# frozen_string_literal: true

require_relative "driver"

# A host that several tests share.
class SharingTest < HostTest
  MARK = "\0rtf scope 2\0"

  def ask(host, number, body, **more)
    params = plugin(body, name: "plugin#{number}.rb", is_last: false, end_marker: MARK, **more)
    host.send("run-test", params, number)
    host.answer["result"]
  end

  def test_it_stays_after_a_test_that_passed_and_ends_after_the_last_one
    host = self.host
    assert_equal({ "outcome" => "passed", "continues" => true }, ask(host, 2, arm("puts \"one\"")))
    assert_equal({ "outcome" => "passed" }, ask(host, 3, arm("puts \"two\""), is_last: true))
    status, output = host.finish
    assert_predicate status, :success?
    # Each output has a mark, and here both outputs are one.
    assert_equal "one\n#{MARK}#{MARK}two\n", output
    phases = host.of("phase").map { |params| params["phase"] }
    assert_equal %w[load setup run tear-down] * 2, phases
  end

  def test_it_ends_after_a_test_that_did_not_pass
    host = self.host
    assert_equal "failed", ask(host, 2, arm("fail(\"no\")"))["outcome"]
    status, output = host.finish
    assert_equal [true, ""], [status.success?, output]
  end

  def test_in_a_campaign_it_stays_after_a_failure_and_sets_the_variables_of_each_test
    host = self.host
    body = arm("report(ENV.fetch(\"RTF_EPISODE\")); fail(\"no\")")
    %w[1 2].each do |episode|
      variables = [{ name: "RTF_EPISODE", value: episode }]
      answer = ask(host, 2, body, continues_after_failure: true, variables: variables)
      assert_equal({ "outcome" => "failed", "continues" => true }, answer)
    end
    assert_equal %w[1 2], host.texts.map(&:last) - ["no"]
  end

  def test_a_request_that_crosses_the_last_answer_does_not_change_the_exit_code
    host = self.host
    assert_equal "failed", ask(host, 2, arm("at_exit { sleep(0.5) }; fail(\"no\")"))["outcome"]
    host.send("run-test", plugin(arm("nil"), name: "later.rb", is_last: false, end_marker: MARK), 3)
    host.close
    status, = host.finish
    assert_predicate status, :success?
  end

  def test_it_ends_after_a_test_that_left_a_process_wherever_that_went
    host = self.host
    left = "Process.wait(spawn(\"setsid sh -c 'sleep 1000 & echo $! > pid'\"))"
    assert_equal({ "outcome" => "passed" }, ask(host, 2, arm(left)))
    status, = Process.wait2(host.pid)
    assert_equal host.pid, status
  ensure
    Process.kill(:KILL, Integer(File.read(File.join(@directory, "pid"))))
  end

  def test_a_child_that_has_ended_is_not_left
    host = self.host
    assert ask(host, 2, arm("spawn(\"true\"); sleep(0.2)"))["continues"]
  end

  def test_nothing_that_a_file_defined_is_there_for_the_next_one
    host = self.host
    one = "#{arm("report(helper)")}Left = 1\ndef helper = \"mine\"\n"
    two = arm("report([defined?(Left), defined?(helper)].inspect)")
    assert ask(host, 2, one)["continues"]
    assert ask(host, 3, two)["continues"]
    # The same file runs again.
    assert ask(host, 2, one)["continues"]
    assert_equal ["mine", "[nil, nil]", "mine"], host.texts.map(&:last)
  end

  def test_an_interrupt_for_a_test_that_is_over_does_not_stop_the_next_one
    host = self.host
    assert ask(host, 2, arm("report(\"one\")"))["continues"]
    waits = arm("sleep(0.3); report(\"two\")")
    host.send("run-test", plugin(waits, name: "two.rb", is_last: false, end_marker: MARK), 3)
    nil until host.wait_for("phase")["phase"] == "run"
    host.send("interrupt", { reason: "late", request: 2 })
    assert_equal({ "outcome" => "passed", "continues" => true }, host.answer["result"])
    third = plugin(arm("sleep"), name: "three.rb", is_last: false, end_marker: MARK)
    host.send("run-test", third, 4)
    nil until host.wait_for("phase")["phase"] == "run"
    host.send("interrupt", { reason: "in time", request: 4 })
    assert_equal "interrupted", host.answer["result"]["outcome"]
  end
end
