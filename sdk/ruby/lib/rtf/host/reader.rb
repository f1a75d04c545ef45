# frozen_string_literal: true

require "json"

require "rtf/request_state"

module RTF
  module Host
    # A request of the runner.
    class Request
      attr_reader :number, :method, :params, :state

      # Reads a message with a number and a method.
      def initialize(message)
        @number = message["id"]
        @method = message["method"]
        params = message["params"]
        @params = params.is_a?(Hash) ? params : {}
        @state = RequestState.new
      end
    end

    # Reads the channel, also while a plug-in runs.
    class Reader
      PARSE_ERROR = -32_700
      INVALID_REQUEST = -32_600
      # A plug-in that polls `interrupted?` has this time to end by itself. Then Interrupted
      # is raised in it, so that its tear-down still runs.
      STOP_GRACE_SECONDS = 0.5
      # A plug-in may rescue that: the interval at which it is raised again.
      STOP_INTERVAL_SECONDS = 0.1

      # Starts reading in a thread that does not keep the process alive.
      def initialize(channel)
        @channel = channel
        @requests = Queue.new
        @open = []
        @last_answered = false
        @fixture_up = false
        @lock = Mutex.new
        @main = Thread.current
        Threads.start("rtf channel") { read }
      end

      # The next request; nil when the runner is gone.
      def next
        @requests.pop
      end

      # Forgets a request before its answer, after which the runner may close the channel,
      # unless a fixture is set up, which no other process would stop. After the last
      # one, requests that have not started, or that still arrive, are ignored.
      def finish(request, fixture_up:, last: false)
        request.state.finish
        @lock.synchronize do
          @open.delete(request)
          @open.clear if last
          @last_answered ||= last
          @fixture_up = fixture_up
        end
      end

      private

      def read
        @channel.each_line { |line| handle(line) }
        busy = @lock.synchronize { @open.any? || @fixture_up }
        Channel.end_without_runner if busy
        @requests.push(nil)
      end

      def handle(line)
        message = JSON.parse(line)
        return dispatch(message) if message.is_a?(Hash) && message["method"].is_a?(String)

        @channel.refuse(nil, INVALID_REQUEST, "not a request")
      rescue JSON::ParserError, EncodingError => problem
        @channel.refuse(nil, PARSE_ERROR, "not a JSON text: #{problem.message[0, 200]}")
      end

      def dispatch(message)
        case message["method"]
        when "interrupt" then interrupt(**interruption(message["params"]))
        when "question-closed" then close_question(message["params"])
        when "dump-stack" then @channel.notify("stack", { text: Threads.stacks(@main) })
        else
          return if message["id"].nil?

          request = Request.new(message)
          @lock.synchronize { @open << request unless @last_answered }
          @requests.push(request)
        end
      end

      def close_question(params)
        return unless params.is_a?(Hash)

        request = @lock.synchronize { @open.first }
        ended = { answer: params["answer"], problem: params["problem"] || "no answer" }
        request&.state&.close_question(params["question"], **ended)
      end

      def interruption(params)
        params = {} unless params.is_a?(Hash)
        { reason: params["reason"] || "asked to stop", number: params["request"] }
      end

      def interrupt(reason:, number:)
        waiting = @lock.synchronize { @open.dup }
        # Crossed the answer to that request, if another one is carried out.
        waiting = waiting.take(1).select { |request| request.number == number } if number
        waiting.each { |request| request.state.request_stop(reason.to_s) }
        # The plug-in may hang and be killed.
        Session.running&.sampling&.send_pending
        first = waiting.first
        Threads.start("rtf stop") { stop(first.state) } if first
      end

      def stop(request)
        seconds = STOP_GRACE_SECONDS
        until request.wait_for_end(seconds)
          request.stop
          seconds = STOP_INTERVAL_SECONDS
        end
      end
    end
  end
end
