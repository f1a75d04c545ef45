--  SPDX-License-Identifier: Apache-2.0

with RobotTestingFramework.ABI;
with RobotTestingFramework.Entry_Point;
pragma Unreferenced (RobotTestingFramework.Entry_Point);
with RobotTestingFramework.Host;

package body RobotTestingFramework.FixtureManager is

   Instance : FixtureManager_Access;

   function Check (Self : in out FixtureManager) return Boolean is
      pragma Unreferenced (Self);
   begin
      return True;
   end Check;

   function TestStarted (Self : in out FixtureManager; Subject : Test) return Boolean is
      pragma Unreferenced (Self, Subject);
   begin
      return True;
   end TestStarted;

   function TestFinished
     (Self : in out FixtureManager; Subject : Test; Verdict, Reason : String) return Boolean
   is
      pragma Unreferenced (Self, Subject, Verdict, Reason);
   begin
      return True;
   end TestFinished;

   procedure Collapsed (Reason : String) is
      Table : constant not null ABI.Host_Access := Host.Table;
      Text  : aliased constant String           := Reason;
   begin
      Table.Collapsed (Table.Context, Host.To_C (Text));
   end Collapsed;

   package body Register is
      procedure Make is
      begin
         SetFixture (new Fixture);
      end Make;
   end Register;

   procedure SetFixture (Fixture : FixtureManager_Access) is
   begin
      Instance := Fixture;
   end SetFixture;

   function Current return FixtureManager_Access is (Instance);

end RobotTestingFramework.FixtureManager;
