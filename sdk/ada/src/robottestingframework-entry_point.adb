--  SPDX-License-Identifier: Apache-2.0

with Ada.Exceptions;
with GNAT.IO;
with GNAT.Most_Recent_Exception;
with Interfaces.C;
with RobotTestingFramework.ABI;
with RobotTestingFramework.Exceptions;
with RobotTestingFramework.FixtureManager;
with RobotTestingFramework.Host;
with RobotTestingFramework.Process;
with RobotTestingFramework.Registry;
with RobotTestingFramework.Session;
with RobotTestingFramework.TestCase;
with System;

package body RobotTestingFramework.Entry_Point is

   use type FixtureManager.FixtureManager_Access;
   use type Interfaces.C.size_t;
   use type System.Address;
   use type TestCase.TestCase_Access;

   subtype Address is ABI.Address;
   subtype Result is Interfaces.Integer_32;

   --  C only gets this address: the plug-in's object is in TestCase or FixtureManager.
   Self_Mark : aliased Integer := 0;

   --  Created when the host asked for the table, and not used yet.
   Is_Made : Boolean := False;

   --  Creates the test or fixture, unless it exists.
   procedure Make is
   begin
      if not Is_Made then
         TestCase.SetTest (null);
         FixtureManager.SetFixture (null);
         Registry.Make;
         if TestCase.Current = null and then FixtureManager.Current = null then
            raise Program_Error with "the plug-in made neither a test nor a fixture";
         end if;
         Is_Made := True;
      end if;
   end Make;

   --  Calls a step, and reports its exception as an error.
   generic
      with function Step return Boolean;
   function Guarded return Result;

   function Guarded return Result is
   begin
      return (if Step then ABI.Done else ABI.Refused);
   exception
      when Assertion_Ended | Critical_Assertion_Ended | Stop_Requested =>
         return ABI.Stopped;
      when Raised : others =>
         Exceptions.Report (Raised);
         return ABI.Stopped;
   end Guarded;

   --  A step without arguments, as C calls it.
   generic
      with function Step return Boolean;
   function C_Step (Self : Address) return Result;

   function C_Step (Self : Address) return Result is
      pragma Unreferenced (Self);
      function Guarded_Step is new Guarded (Step);
   begin
      return Guarded_Step;
   end C_Step;

   function Create (Host_Table : ABI.Host_Access) return Address with Convention => C;
   procedure Destroy (Self : Address) with Convention => C;
   function Set_Up
     (Self : Address; Count : Interfaces.C.int; Arguments : Address) return Result
     with Convention => C;
   function Started (Self : Address; Test : not null access constant ABI.Test) return Result
     with Convention => C;
   function Finished (Self : Address; Test : not null access constant ABI.Test) return Result
     with Convention => C;

   function Create (Host_Table : ABI.Host_Access) return Address is
   begin
      Host.Connect (Host_Table);
      Make;
      return Self_Mark'Address;
   exception
      when Raised : others =>
         Exceptions.Report (Raised);
         return System.Null_Address;
   end Create;

   procedure Destroy (Self : Address) is
      pragma Unreferenced (Self);
   begin
      Is_Made := False;
   end Destroy;

   function Do_Setup return Boolean is
   begin
      if TestCase.Current = null then
         return FixtureManager.Current.Setup (Session.Parameters);
      end if;
      TestCase.Report_Name;
      return TestCase.Current.Setup (Session.Parameters);
   end Do_Setup;
   function Guarded_Setup is new Guarded (Do_Setup);

   function Set_Up
     (Self : Address; Count : Interfaces.C.int; Arguments : Address) return Result
   is
      pragma Unreferenced (Self);
   begin
      Process.Set_Arguments (Count, Arguments);
      return Guarded_Setup;
   end Set_Up;

   function Do_Run return Boolean is
   begin
      TestCase.Current.Run;
      return True;
   end Do_Run;
   function Run is new C_Step (Do_Run) with Convention => C;

   function Do_Check return Boolean is (FixtureManager.Current.Check);
   function Check is new C_Step (Do_Check) with Convention => C;

   --  The test of the notification, during one call.
   Notified : access constant ABI.Test;

   function Notified_Test return FixtureManager.Test is
      Name : constant String := Host.To_Ada (Notified.Name);
   begin
      return
        (Length     => Name'Length,
         Id         => Natural (Notified.Id),
         Repetition => Positive (Notified.Repetition),
         Attempt    => Positive (Notified.Attempt),
         Name       => Name);
   end Notified_Test;

   function Do_Started return Boolean is (FixtureManager.Current.TestStarted (Notified_Test));
   function Guarded_Started is new Guarded (Do_Started);

   function Do_Finished return Boolean is
     (FixtureManager.Current.TestFinished
        (Notified_Test, Host.To_Ada (Notified.Verdict), Host.To_Ada (Notified.Reason)));
   function Guarded_Finished is new Guarded (Do_Finished);

   function Started (Self : Address; Test : not null access constant ABI.Test) return Result is
      pragma Unreferenced (Self);
   begin
      Notified := Test;
      return Guarded_Started;
   end Started;

   function Finished (Self : Address; Test : not null access constant ABI.Test) return Result is
      pragma Unreferenced (Self);
   begin
      Notified := Test;
      return Guarded_Finished;
   end Finished;

   function Do_Tear_Down return Boolean is
   begin
      if TestCase.Current /= null then
         TestCase.Current.TearDown;
      else
         FixtureManager.Current.TearDown;
      end if;
      return True;
   end Do_Tear_Down;
   function Tear_Down is new C_Step (Do_Tear_Down) with Convention => C;

   Table : aliased ABI.Plugin_Table :=
     (Size      => ABI.Plugin_Table'Size / System.Storage_Unit,
      Create    => Create'Access,
      Destroy   => Destroy'Access,
      Set_Up    => Set_Up'Access,
      Tear_Down => Tear_Down'Access,
      others    => <>);

   type Handler is access procedure (Signal : Interfaces.C.int) with Convention => C;

   function C_Signal (Number : Interfaces.C.int; Handle : Handler) return Address
     with Import, Convention => C, External_Name => "signal";

   --  Exists in plug-ins with tasks, whose runtime needs SIGABRT.
   procedure Abort_Task
     with Import, Convention => C,
          External_Name => "system__task_primitives__operations__abort_task";
   pragma Weak_External (Abort_Task);

   --  Removes the handlers that turn signals into exceptions in Ada's runtime, so that a
   --  crash has its signal and its core. The compiler's checks still raise exceptions.
   --  The numbers are Linux's SIGILL, SIGBUS, SIGFPE, SIGSEGV and SIGABRT; a pragma
   --  Interrupt_State with their names would add the tasking runtime to each plug-in.
   procedure Remove_Handlers is
      Faults : constant array (1 .. 4) of Interfaces.C.int := (4, 7, 8, 11);
      Before : Address;
      pragma Unreferenced (Before);
   begin
      for Fault of Faults loop
         Before := C_Signal (Fault, null);
      end loop;
      if Abort_Task'Address = System.Null_Address then
         Before := C_Signal (6, null);
      end if;
   end Remove_Handlers;

   function Plugin return Address
     with Export, Convention => C, External_Name => "rtf_plugin";

   --  Creates the test or fixture to find out its kind. An exception is ignored here:
   --  there is no host yet, and create() reports it.
   function Plugin return Address is
      Is_Fixture : Boolean := False;
   begin
      Remove_Handlers;
      begin
         Make;
         Is_Fixture := TestCase.Current = null;
      exception
         when others =>
            Is_Made := False;
      end;
      Table.Kind  := (if Is_Fixture then ABI.Kind_Fixture else ABI.Kind_Test);
      Table.Run   := (if Is_Fixture then null else Run'Access);
      Table.Check := (if Is_Fixture then Check'Access else null);
      Table.Started  := (if Is_Fixture then Started'Access else null);
      Table.Finished := (if Is_Fixture then Finished'Access else null);
      return Table'Address;
   end Plugin;

   --  An exception during elaboration propagates into the host's code, which calls
   --  abort(): print it before.
   procedure Print_And_Abort (Signal : Interfaces.C.int) with Convention => C;

   procedure Print_And_Abort (Signal : Interfaces.C.int) is
      pragma Unreferenced (Signal);
   begin
      GNAT.IO.Put_Line
        (GNAT.IO.Standard_Error,
         "while the plug-in was elaborated: "
         & Ada.Exceptions.Exception_Information (GNAT.Most_Recent_Exception.Occurrence));
      Remove_Handlers;
   end Print_And_Abort;

   Before : Address;
   pragma Unreferenced (Before);

begin
   --  Elaborated before everything that depends on TestCase or FixtureManager.
   if Abort_Task'Address = System.Null_Address then
      Before := C_Signal (6, Print_And_Abort'Access);
   end if;
end RobotTestingFramework.Entry_Point;
