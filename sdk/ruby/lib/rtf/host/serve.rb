# frozen_string_literal: true

require "rtf/host/channel"
require "rtf/host/reader"
require "rtf/host/steps"
require "rtf/host/threads"
require "rtf/session"

module RTF
  module Host
    # Carries out the runner's requests, in order.
    class Serve
      PROTOCOL_VERSION = 1
      INVALID_REQUEST = -32_600
      METHOD_NOT_FOUND = -32_601
      INVALID_PARAMS = -32_602
      VERSION_MISMATCH = -32_001

      # A request that cannot be carried out.
      class Refused < StandardError
        attr_reader :code

        def initialize(code, text)
          super(text)
          @code = code
        end
      end

      # Serves the runner and returns the exit code.
      def self.serve
        begin
          channel = Channel.from_environment
        rescue ArgumentError, SystemCallError => problem
          warn "error: this is a host, which `rtf` starts by itself: #{problem.message}"
          return 2
        end
        # A crash must not lose printed lines with the buffer.
        [$stdout, $stderr].each { |stream| stream.sync = true }
        Threads.watch
        new(channel).run
        0
      end

      def initialize(channel)
        @channel = channel
        @initialized = false
        @shared = nil
      end

      # Carries out requests until the last one, or until the runner is gone.
      def run
        reader = Reader.new(@channel)
        loop do
          request = reader.next
          break unless request && carry_out(request, reader)
        end
      end

      private

      # Carries out a request and answers; whether there may be another one.
      def carry_out(request, reader)
        result, last = result_of(request)
        reader.finish(request, fixture_up: !@fixture.nil?, last: last)
        @channel.answer(request.number, result)
        !last
      rescue Refused => refused
        reader.finish(request, fixture_up: !@fixture.nil?)
        @channel.refuse(request.number, refused.code, refused.message)
        true
      end

      def result_of(request)
        return initialize_host(request.params) if request.method == "initialize"
        unless @initialized
          raise Refused.new(INVALID_REQUEST, "the first request must be `initialize`")
        end

        case request.method
        when "run-test" then run_test(request)
        when "set-up-fixture" then set_up_fixture(request)
        when "check-fixture" then Steps.check_fixture(enter(@task, request), @fixture)
        when "test-started", "test-finished" then notify_fixture(request)
        when "tear-down-fixture" then tear_down_fixture(request)
        else raise Refused.new(METHOD_NOT_FOUND, "unknown method `#{request.method}`")
        end
      end

      def initialize_host(params)
        unless params["protocol"] == PROTOCOL_VERSION
          raise Refused.new(VERSION_MISMATCH,
                            "rtf #{params["rtf"]} speaks version #{params["protocol"]} of the " \
                            "host protocol, this host version #{PROTOCOL_VERSION}")
        end
        @initialized = true
        { protocol: PROTOCOL_VERSION, host: "ruby #{RUBY_VERSION}", stack: "message",
          supports_shared: true, selects_cases: true }
      end

      def run_test(request)
        task = task(request)
        session = enter(task, request)
        task.end_marker.empty? ? [Steps.run_test(session), task.last?] : run_shared(session)
      end

      # Runs one of several tests in this process; also returns whether it was the last one.
      def run_shared(session)
        task = session.task
        require "rtf/host/shared_host"
        @shared ||= SharedHost.begin unless task.last?
        session.announce("load")
        ENV.update(task.variables)
        answer = Steps.run_test(session)
        continues = task.continues_after?(answer[:outcome]) && !task.last? &&
                    @shared&.end_test(task.end_marker)
        continues ? [answer.merge(continues: true), false] : [answer, true]
      end

      def set_up_fixture(request)
        @task = task(request)
        @fixture, answer = Steps.set_up_fixture(enter(@task, request), @fixture)
        answer
      end

      def notify_fixture(request)
        session = enter(@task, request)
        session.task.attachments_dir = request.params["attachments_dir"].to_s
        Steps.notify_fixture(session, @fixture, request.method, request.params)
      ensure
        session.task.attachments_dir = "" if session
      end

      def tear_down_fixture(request)
        fixture = @fixture
        @fixture = nil
        Steps.tear_down_fixture(enter(@task, request), fixture)
      end

      def task(request)
        Task.new(request.params)
      rescue TypeError => problem
        raise Refused.new(INVALID_PARAMS, problem.message)
      end

      def enter(task, request)
        task ||= Task.new({ "file" => "", "name" => "" })
        Session.new(task, request.state, @channel).tap { |session| Session.enter(session) }
      end
    end
  end
end
