# frozen_string_literal: true

require "rtf/host/load"
require "rtf/host/yarp_network"
require "rtf/session"

module RTF
  module Host
    # Carries out the steps of a plug-in: set-up, run, check, tear-down.
    module Steps
      module_function

      # Loads a test, sets it up, runs it and tears it down.
      def run_test(session)
        test = load(session, TestCase)
        if test
          session.announce("setup")
          session.sampling.begin
          step(session, "setup") { test.setup(session.task.args) }
          if session.request.passed?
            session.announce("run")
            step(session, "run") { test.run }
          end
          session.announce("tear-down")
          tear_down(session, test)
        end
        answer(session)
      end

      # Loads a fixture and sets it up. Returns the fixture if it was loaded.
      def set_up_fixture(session, present)
        if present
          session.request.record("error", "a fixture is still set up in this host")
          return [present, answer(session)]
        end
        fixture = load(session, FixtureManager)
        step(session, "setup") { fixture.setup(session.task.args) } if fixture
        answer = answer(session)
        wanted = fixture && session.request.passed? ? subscriptions(fixture) : []
        answer[:subscriptions] = wanted if wanted.any?
        [fixture, answer]
      end

      # The notifications for which a fixture has a method.
      def subscriptions(fixture)
        own = ->(name) { fixture.method(name).owner != FixtureManager }
        [*("test-started" if own[:test_started]), *("test-finished" if own[:test_finished])]
      end

      # Notifies a fixture that a test is about to start, or of its verdict.
      def notify_fixture(session, fixture, method, params)
        test = Test.new(*(params["test"] || {}).values_at("id", "name", "repetition", "attempt"))
        if fixture.nil?
          session.request.record("error", "no fixture is set up")
        elsif method == "test-started"
          step(session, "test_started") { fixture.test_started(test) }
        else
          verdict = [params["verdict"], params["reason"].to_s]
          step(session, "test_finished") { fixture.test_finished(test, *verdict) }
        end
        answer(session)
      end

      # Calls a fixture's `check`.
      def check_fixture(session, fixture)
        if fixture
          step(session, "check") { fixture.check }
        else
          session.request.record("error", "no fixture is set up")
        end
        answer(session)
      end

      # Tears a fixture down, if it was loaded.
      def tear_down_fixture(session, fixture)
        tear_down(session, fixture) if fixture
        answer(session)
      end

      def load(session, base)
        guard(session) { Load.load(session.task.file, base) }.tap do |plugin|
          YarpNetwork.init if plugin
        end
      end

      # Carries out a step and checks its result.
      def step(session, name, &block)
        result = guard(session, &block)
        return unless result == false && name != "run"

        outcome = name == "setup" ? "error" : "failed"
        session.request.record(outcome, "#{name} returned false")
      end

      def tear_down(session, plugin)
        session.request.clear_stop
        guard(session) { plugin.tear_down }
        YarpNetwork.finish
      end

      # Calls the plug-in and reports its exception. Only SystemExit propagates: the plug-in
      # ends its process.
      def guard(session, &block)
        process = Process.pid
        result = call(session, &block)
        return result if Process.pid == process

        # A forked child returned from the plug-in; its parent serves the runner.
        flush_output
        session.sampling.send_pending
        exit!(0)
      end

      def call(session, &block)
        session.request.enter_plugin(&block)
      rescue SystemExit
        raise
      rescue StepEnded
        nil # recorded before it was raised
      rescue LoadError => problem
        problem.is_a?(Load::NoPlugin) ? session.error(problem.message) : session.exception(problem)
        nil
      rescue Exception => problem # rubocop:disable Lint/RescueException
        session.exception(problem)
        nil
      end

      def flush_output
        [$stdout, $stderr].each(&:flush)
      end

      def answer(session)
        flush_output
        session.sampling.send_pending
        session.request.answer
      end
    end
  end
end
