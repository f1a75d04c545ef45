# frozen_string_literal: true

require "rtf/text"

module RTF
  # A fault that the test has injected. It ends with the test at the latest.
  class Fault
    SOCKET = "faults.socket"
    private_constant :SOCKET

    attr_reader :name

    # Injects the fault, and waits until it has begun.
    def initialize(session, name)
      @session = session
      @name = Text.utf8(name)
      request("inject", "injected")
    end

    # Removes the fault. No effect if it has ended already.
    def remove
      request("remove", "removed")
    end

    private

    def request(verb, done)
      @session.sampling.send_pending
      problem = answer("#{verb}\n#{@name}\n#{@session.task.name}\n")
      return if problem.empty?

      @session.end_with_error("the fault \"#{@name}\" was not #{done}: #{problem}")
    end

    # The problem, empty if it is done.
    def answer(request)
      address = @session.task.fixture_values[SOCKET]
      return "the suite declares no `<fault>` without `at`" unless address

      require "socket" # slow to load, and most tests inject nothing
      UNIXSocket.open("\0#{address}") do |connection|
        connection.write(request)
        connection.read.force_encoding(Encoding::UTF_8)
      end
    rescue SystemCallError => problem
      "the fixture `faults` does not answer: #{problem.message}"
    end
  end
end
